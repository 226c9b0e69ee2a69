// Builds the files that scripts/make-starter wrote to starter/ into the program.
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
