/* SPDX-License-Identifier: Apache-2.0 */
#include "world/parse/lexer.h"

#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { LEXER_NUMBER_MAX = 63 };

static bool lexer_is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static bool lexer_starts_word(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static bool lexer_in_word(char c)
{
    return lexer_starts_word(c) || lexer_is_digit(c) || c == '.' || c == '-';
}

static bool lexer_starts_number(char c)
{
    return lexer_is_digit(c) || c == '-' || c == '+' || c == '.';
}

void lexer_init(struct lexer *lexer, const char *text, size_t len)
{
    static const char mark[] = "\xef\xbb\xbf"; /* some editors put one first */
    if (len >= 3 && memcmp(text, mark, 3) == 0) {
        text += 3;
        len -= 3;
    }
    *lexer = (struct lexer){.at = text, .end = text + len, .line_start = text, .line = 1};
}

static void lexer_skip_space(struct lexer *lexer)
{
    while (lexer->at < lexer->end) {
        char c = *lexer->at;
        if (c == '#') {
            const char *newline = memchr(lexer->at, '\n', (size_t)(lexer->end - lexer->at));
            lexer->at = newline ? newline : lexer->end;
        } else if (c == '\n') {
            lexer->at++;
            lexer->line += lexer->line < INT_MAX;
            lexer->line_start = lexer->at;
        } else if (c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v') {
            lexer->at++;
        } else {
            return;
        }
    }
}

static void lexer_refuse(struct token *token, const char *why)
{
    token->kind = TOKEN_BAD;
    token->text = why;
    token->len = strlen(why);
}

/* Reads "[12]" where it stands without a gap behind a word, as Stage does.  Else: nothing. */
static bool lexer_take_index(struct lexer *lexer)
{
    const char *p = lexer->at;
    if (p == lexer->end || *p != '[') {
        return false;
    }
    const char *digits = ++p;
    while (p < lexer->end && lexer_is_digit(*p)) {
        p++;
    }
    if (p == digits || p == lexer->end || *p != ']') {
        return false;
    }
    lexer->at = p + 1;
    return true;
}

static void lexer_take_word(struct lexer *lexer, struct token *token)
{
    do {
        while (lexer->at < lexer->end && lexer_in_word(*lexer->at)) {
            lexer->at++;
        }
    } while (lexer_take_index(lexer));
    token->kind = TOKEN_WORD;
    token->len = (size_t)(lexer->at - token->text);
}

static void lexer_take_string(struct lexer *lexer, struct token *token)
{
    const char *p = ++lexer->at;
    while (p < lexer->end && *p != '"' && *p != '\n' && *p != '\0') {
        p++;
    }
    token->text = lexer->at;
    token->len = (size_t)(p - lexer->at);
    token->kind = TOKEN_STRING;
    lexer->at = p;
    if (p == lexer->end || *p != '"') {
        lexer_refuse(token, "expected '\"' at the end of the text, before the line ends");
        return;
    }
    lexer->at++;
}

static void lexer_take_number(struct lexer *lexer, struct token *token)
{
    const char *p = lexer->at;
    while (p < lexer->end && (lexer_in_word(*p) || *p == '+')) {
        p++;
    }
    token->len = (size_t)(p - lexer->at);
    lexer->at = p;
    char copy[LEXER_NUMBER_MAX + 1];
    if (token->len > LEXER_NUMBER_MAX) {
        lexer_refuse(token, "expected a number, found too many digits");
        return;
    }
    memcpy(copy, token->text, token->len);
    copy[token->len] = '\0';
    char *rest = NULL;
    token->number = strtod(copy, &rest);
    /* strtod also takes hexadecimal digits, inf and nan: their letters are not a number's here */
    if (rest == copy || *rest != '\0' || strspn(copy, "+-.0123456789eE") != token->len) {
        lexer_refuse(token, "expected a number");
    } else if (!isfinite(token->number)) {
        lexer_refuse(token, "expected a finite number, found one that is too large");
    } else {
        token->kind = TOKEN_NUMBER;
    }
}

void lexer_next(struct lexer *lexer, struct token *token)
{
    static const struct {
        char c;
        enum token_kind kind;
    } marks[] = {
        {'(', TOKEN_OPEN}, {')', TOKEN_CLOSE}, {'[', TOKEN_OPEN_TUPLE}, {']', TOKEN_CLOSE_TUPLE}};
    lexer_skip_space(lexer);
    ptrdiff_t column = lexer->at - lexer->line_start + 1;
    *token = (struct token){.kind = TOKEN_END,
                            .text = lexer->at,
                            .line = lexer->line,
                            .column = column > INT_MAX ? INT_MAX : (int)column};
    if (lexer->at == lexer->end) {
        return;
    }
    char c = *lexer->at;
    for (size_t i = 0; i < sizeof marks / sizeof marks[0]; i++) {
        if (marks[i].c == c) {
            token->kind = marks[i].kind;
            token->len = 1;
            lexer->at++;
            return;
        }
    }
    if (lexer_starts_word(c)) {
        lexer_take_word(lexer, token);
    } else if (c == '"') {
        lexer_take_string(lexer, token);
    } else if (lexer_starts_number(c)) {
        lexer_take_number(lexer, token);
    } else {
        lexer->at++;
        lexer_refuse(token, "expected a name, a value or a bracket, found a stray character");
    }
}
