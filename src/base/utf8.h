/* Characters of UTF-8. */
#ifndef HEWN_SRC_BASE_UTF8_H
#define HEWN_SRC_BASE_UTF8_H

#include <stddef.h>
#include <stdint.h>

/* How many bytes the character at `text` has, of which `left` may be read; 0 for what is no UTF-8 (RFC 3629: overlong
 * forms, surrogates and what lies past U+10FFFF are none). Where a NUL ends the text `left` may be SIZE_MAX, since
 * nothing past a NUL is read. */
size_t hewn_utf8_next(const char *text, size_t left, uint32_t *out);

#endif
