/* SPDX-License-Identifier: Apache-2.0 */
#include "core/probe.h"

#include "muster/limits.h"

#include <string.h>

/* What shows facts, rules, other constructs and the agent's own pages, and changes nothing: no
 * fact, no activation, no random number, no name made up, not what a robot's sensors read. */
static const char *const words[] = {
    "agenda",
    "dependencies",
    "dependents",
    "facts",
    "failures",
    "find-service",
    "get-current-module",
    "get-focus",
    "get-strategy",
    "groups",
    "list-deffacts",
    "list-deffunctions",
    "list-defgenerics",
    "list-defglobals",
    "list-defmethods",
    "list-defmodules",
    "list-defrules",
    "list-deftemplates",
    "list-focus-stack",
    "list-watch-items",
    "listing",
    "lookup",
    "matches",
    "members",
    "my-name",
    "now",
    "ppdeffacts",
    "ppdeffunction",
    "ppdefgeneric",
    "ppdefglobal",
    "ppdefmethod",
    "ppdefmodule",
    "ppdefrule",
    "ppdeftemplate",
    "ppfact",
    "rules",
    "set-aside",
    "show-breaks",
    "show-defglobals",
};

enum { WORDS = sizeof words / sizeof words[0] };

static const char blanks[] = " \t\r\n";

/* Of symbols and numbers: nothing that is a variable, a string, a constraint or a comment. */
static const char literal_bytes[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                    "-_.:+*/!@#%^,'{}";

const char *mu_probe_at(size_t index)
{
    return index < WORDS ? words[index] : NULL;
}

static bool is_word(const char *at, size_t len)
{
    for (size_t i = 0; i < WORDS; i++) {
        if (strlen(words[i]) == len && memcmp(words[i], at, len) == 0) {
            return true;
        }
    }
    return false;
}

/* Passes literals between blanks.  @return where they end */
static const char *literals_skip(const char *at)
{
    at += strspn(at, blanks);
    while (*at && strchr(literal_bytes, *at)) {
        at += strspn(at, literal_bytes);
        at += strspn(at, blanks);
    }
    return at;
}

static bool ends(const char *at)
{
    return at[strspn(at, blanks)] == '\0';
}

static bool global_is(const char *line)
{
    size_t len = line[0] == '?' ? 1 + strspn(line + 1, literal_bytes) : 0;
    return len >= 4 && line[1] == '*' && line[len - 1] == '*' && ends(line + len);
}

size_t mu_probe_word(const char *line, const char **word)
{
    line += strspn(line, blanks);
    if (*line != '(') {
        return 0;
    }
    *word = line + 1 + strspn(line + 1, blanks);
    return strspn(*word, literal_bytes);
}

bool mu_probe_is(const char *line)
{
    const char *word = line;
    if (strnlen(line, MU_GLANCE_LINE_MAX + 1) > MU_GLANCE_LINE_MAX) {
        return false;
    }
    size_t len = mu_probe_word(line, &word);
    if (len == 0) {
        return global_is(line + strspn(line, blanks));
    }
    const char *end = literals_skip(word + len);
    return is_word(word, len) && *end == ')' && ends(end + 1);
}
