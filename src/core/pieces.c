/* SPDX-License-Identifier: Apache-2.0 */
#include "core/pieces.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* @return the bytes of the next piece */
static size_t piece_len(const char *at, size_t size)
{
    size_t len = strnlen(at, size);
    if (len < size) {
        return len;
    }
    len = size - 1;
    const char *line = memrchr(at, '\n', len);
    if (line) {
        return (size_t)(line + 1 - at);
    }
    size_t begin = len; /* of the character at the end: at most three bytes back */
    while (begin > len - 4 && ((unsigned char)at[begin] & 0xc0) == 0x80) {
        begin--;
    }
    return ((unsigned char)at[begin] & 0xc0) == 0x80 ? len : begin;
}

bool mu_pieces_next(const char **at, char *piece, size_t size)
{
    size_t len = piece_len(*at, size);
    memcpy(piece, *at, len);
    piece[len] = '\0';
    *at += len;
    return len > 0;
}

uint32_t mu_pieces_count(const char *text, size_t size)
{
    uint32_t count = 0;
    for (size_t len; (len = piece_len(text, size)) > 0; text += len) {
        count++;
    }
    return count > 0 ? count : 1;
}

size_t mu_pieces_numbered(char content[MU_CONTENT_MAX + 1], uint32_t number, const char *text,
                          size_t len, size_t at)
{
    size_t bytes = len - at < MU_PIECES_NUMBERED_MAX ? len - at : MU_PIECES_NUMBERED_MAX;
    while (at + bytes < len && ((unsigned char)text[at + bytes] & 0xc0) == 0x80 && bytes > 1) {
        bytes--; /* mail is whole characters */
    }
    int head = snprintf(content, MU_CONTENT_MAX + 1, "%" PRIu32 " %zu\n", number, len);
    memcpy(content + head, text + at, bytes);
    content[(size_t)head + bytes] = '\0';
    return bytes;
}
