/* SPDX-License-Identifier: Apache-2.0 */
#include "operator/operator.h"

#include <stdio.h>
#include <string.h>

struct complete_word complete_word(const char *line, size_t len)
{
    size_t begin = len;
    while (begin > 0 && !strchr(" \t\n()\";&|~", line[begin - 1])) {
        begin--;
    }
    return (struct complete_word){
        .at = line + begin, .len = len - begin, .begins = begin > 0 && line[begin - 1] == '('};
}

/* @return the next line of the words, or NULL */
static const char *line_next(const char **from, size_t *len)
{
    const char *line = *from;
    if (!*line) {
        return NULL;
    }
    *len = strcspn(line, "\n");
    *from = line + *len + (line[*len] == '\n');
    return line;
}

static bool line_fits(const char *line, size_t len, struct complete_word w)
{
    bool kind = !w.begins || *line == 'f' || *line == 't';
    return kind && len >= 2 + w.len && memcmp(line + 2, w.at, w.len) == 0;
}

/* @return whether the same name stands in an earlier line that fits */
static bool line_was(const char *words, const char *line, size_t len, struct complete_word w)
{
    size_t other_len = 0;
    const char *other = line_next(&words, &other_len);
    for (; other && other < line; other = line_next(&words, &other_len)) {
        if (other_len == len && memcmp(other + 2, line + 2, len - 2) == 0 &&
            line_fits(other, other_len, w)) {
            return true;
        }
    }
    return false;
}

bool complete_next(const char *words, const char **from, struct complete_word w,
                   struct complete_match *match)
{
    const char *line;
    size_t len = 0;
    while ((line = line_next(from, &len))) {
        if (line_fits(line, len, w) && !line_was(words, line, len, w)) {
            *match = (struct complete_match){.at = line + 2, .len = len - 2};
            return true;
        }
    }
    return false;
}

size_t complete_common(const char *words, struct complete_word w, size_t *count,
                       struct complete_match *first)
{
    struct complete_match match;
    const char *from = words;
    size_t common = 0;
    *count = 0;
    while (complete_next(words, &from, w, &match)) {
        if ((*count)++ == 0) {
            *first = match;
            common = match.len;
        }
        size_t same = 0;
        while (same < common && same < match.len && first->at[same] == match.at[same]) {
            same++;
        }
        common = same;
    }
    while (common > w.len && (first->at[common] & 0xc0) == 0x80) {
        common--; /* not in the middle of a character */
    }
    return common > w.len ? common - w.len : 0;
}

size_t complete_rest(const char *words, struct complete_word w, char rest[COMPLETE_REST])
{
    struct complete_match first;
    size_t count, common = complete_common(words, w, &count, &first);
    int len = common < COMPLETE_REST - 2 ? (int)common : 0;
    rest[0] = '\0';
    if (count == 1 || len > 0) {
        snprintf(rest, COMPLETE_REST, "%.*s%s", len, first.at + w.len, count == 1 ? " " : "");
    }
    return count;
}
