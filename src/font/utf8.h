/* Characters of UTF-8. */
#ifndef HEWN_SRC_FONT_UTF8_H
#define HEWN_SRC_FONT_UTF8_H

#include <stddef.h>
#include <stdint.h>

/* How many bytes the character at `text` has, which a NUL ends; 0 for what is no UTF-8 (RFC 3629). */
size_t hewn_utf8_next(const char *text, uint32_t *out);

#endif
