// What scripts/make-starter wrote, as part of the program; found in the folder starter/.
    .section .rodata
    .balign 16
    .global canonpose_starter_begin, canonpose_starter_end
canonpose_starter_begin:
    .incbin "starter.cpm"
canonpose_starter_end:
    .global canonpose_starter_card_begin, canonpose_starter_card_end
canonpose_starter_card_begin:
    .incbin "starter.json"
canonpose_starter_card_end:
    .section .note.GNU-stack, "", %progbits
