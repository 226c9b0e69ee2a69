// Builds the page's own files into the program: the HTML and style of viewer/, and its bundled script.
    .section .rodata
    .balign 16
    .global canonpose_page_html_begin, canonpose_page_html_end
canonpose_page_html_begin:
    .incbin "page.html"
canonpose_page_html_end:
    .global canonpose_page_style_begin, canonpose_page_style_end
canonpose_page_style_begin:
    .incbin "style.css"
canonpose_page_style_end:
    .global canonpose_page_script_begin, canonpose_page_script_end
canonpose_page_script_begin:
    .incbin "viewer.js"
canonpose_page_script_end:
    .section .note.GNU-stack, "", %progbits
