/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file lexer.h
 * The words of a world file.  Pure: reads memory, keeps nothing.
 */
#ifndef MUSTER_WORLD_LEXER_H
#define MUSTER_WORLD_LEXER_H

#include <stddef.h>

enum token_kind {
    TOKEN_END,
    TOKEN_OPEN,        /* ( */
    TOKEN_CLOSE,       /* ) */
    TOKEN_OPEN_TUPLE,  /* [ */
    TOKEN_CLOSE_TUPLE, /* ] */
    TOKEN_WORD,        /* with an index in it, if it bears one: point[0] */
    TOKEN_STRING,      /* text is between the quotes */
    TOKEN_NUMBER,      /* always finite */
    TOKEN_BAD          /* text is the mistake */
};

struct token {
    enum token_kind kind;
    const char *text; /* not zero-terminated; lives as long as the text */
    size_t len;
    double number;
    int line, column; /* from 1; columns count bytes */
};

struct lexer {
    const char *at, *end;
    const char *line_start;
    int line;
};

void lexer_init(struct lexer *lexer, const char *text, size_t len);

/** Reads the next token.  After TOKEN_END, TOKEN_END again; after TOKEN_BAD, whatever comes. */
void lexer_next(struct lexer *lexer, struct token *token);

#endif
