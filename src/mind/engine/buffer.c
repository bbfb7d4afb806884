/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What the engine prints into buffers of a fixed size, or of a size that grows too slowly: the same
 * as it does, but never behind the end.
 */
#include "mind/engine/clips_engine.h"

#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { BUFFER_INDENT_MAX = 118, BUFFER_STEP_LEAST = 80 };

/* The buffers that are too small for what rules make them hold, by what is printed into them. */
static const struct {
    const char *format;
    size_t bytes;
} buffer_small[] = {
    {"f-%lld", 20},                            /* retract, modify, dependencies, ... */
    {"f-%-5lld ", 20},                         /* facts */
    {"fact f-%-5lld ", 20},                    /* a slot of the wrong type */
    {"   Problem resides in slot %s\n", 60},   /* an error in a pattern */
    {"   Problem resides in field #%d\n", 60}, /* likewise */
};

int gensprintf(char *buffer, const char *format, ...)
{
    size_t bytes = INT_MAX;
    for (size_t i = 0; i < sizeof buffer_small / sizeof buffer_small[0]; i++) {
        if (strcmp(format, buffer_small[i].format) == 0) {
            bytes = buffer_small[i].bytes;
        }
    }
    va_list arguments;
    va_start(arguments, format);
    int printed = vsnprintf(buffer, bytes, format, arguments);
    va_end(arguments);
    if (printed > 0 && (size_t)printed >= bytes && format[strlen(format) - 1] == '\n') {
        buffer[bytes - 2] = '\n';
    }
    return printed;
}

/* A new line of the text of a construct.  What is nested more deeply stands no further right. */
void PPCRAndIndent(void *env)
{
    const struct prettyPrintData *text = PrettyPrintData(env);
    char line[BUFFER_INDENT_MAX + 2] = "\n";
    if (text->PPBufferStatus == OFF || !text->PPBufferEnabled) {
        return;
    }
    int depth = text->IndentationDepth;
    depth = depth < 0 ? 0 : depth > BUFFER_INDENT_MAX ? BUFFER_INDENT_MAX : depth;
    memset(line + 1, ' ', (size_t)depth);
    line[depth + 1] = '\0';
    SavePPBuffer(env, line);
}

/* A word that is read, letter by letter: its room doubles, where the engine's grew by 80 bytes. */
char *ExpandStringWithChar(void *env, int letter, char *word, size_t *len, size_t *room,
                           size_t wanted)
{
    if (*len + 1 >= *room) {
        size_t more = *room < BUFFER_STEP_LEAST ? BUFFER_STEP_LEAST : 2 * *room;
        more = more < wanted ? wanted : more;
        word = genrealloc(env, word, *room, more);
        *room = more;
    }
    if (letter != '\b') {
        word[(*len)++] = (char)letter;
    } else {
        while (*len > 1 && ((unsigned char)word[*len - 1] & 0xC0) == 0x80) {
            (*len)--; /* what continues a letter of several bytes */
        }
        *len -= *len > 0;
    }
    word[*len] = '\0';
    return word;
}
