/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file pieces.h
 * A long text in pieces that mails can carry: each ends with a line where it can, and never inside
 * a character of UTF-8.
 */
#ifndef MUSTER_CORE_PIECES_H
#define MUSTER_CORE_PIECES_H

#include "muster/limits.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/**
 * Copies the next piece and moves on.
 *
 * @param at    where the rest of the text begins; moved behind the piece
 * @param size  bytes of piece with its zero; at least 8
 * @return whether there was anything left
 */
bool mu_pieces_next(const char **at, char *piece, size_t size);

/** @return how many pieces a text has; 1 for an empty one */
uint32_t mu_pieces_count(const char *text, size_t size);

/* Bytes of the text in one numbered piece; the rest of a mail is for its head. */
enum { MU_PIECES_NUMBERED_MAX = MU_CONTENT_MAX - 64 };

/**
 * Makes the content of a mail with a piece of a text that a host puts together again: a line
 * "NUMBER BYTES", with the bytes of the whole text, and the piece.
 *
 * @param number  of the piece, from 0 on
 * @param at      where the piece begins in the text's len bytes; < len
 * @return bytes of the text in it
 */
size_t mu_pieces_numbered(char content[MU_CONTENT_MAX + 1], uint32_t number, const char *text,
                          size_t len, size_t at);

#endif
