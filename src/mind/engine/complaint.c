/* SPDX-License-Identifier: Apache-2.0 */
/* Errors of rules and functions: each complaint is printed once. */
#include "core/hash.h"
#include "mind/engine/engine.h"

#include <string.h>

/* Remembers a complaint, without its numbers.  @return whether it was shown before */
static bool complaint_was_shown(struct mind *m, const char *text)
{
    uint64_t hash = MU_HASH_EMPTY;
    for (const char *c = text; *c; c++) {
        bool number = (*c >= '0' && *c <= '9') || *c == '.' || *c == '-';
        hash = number ? hash : mu_hash_bytes(hash, c, 1);
    }
    for (size_t i = 0; i < m->shown_count; i++) {
        if (m->shown[i] == hash) {
            return true;
        }
    }
    if (m->shown_count == COMPLAINT_SHOWN_MAX) {
        return true;
    }
    m->shown[m->shown_count++] = hash;
    return false;
}

/* Cuts off the message that the actions of this rule were halted. */
static void complaint_cut(char *said, const char *kind)
{
    static const char halt[] = "[PRCCODE4] Execution halted during the actions of def";
    char *halted = strstr(said, halt);
    while (halted && strncmp(halted + sizeof halt - 1, kind, strlen(kind)) != 0) {
        halted = strstr(halted + 1, halt);
    }
    if (halted) {
        *halted = '\0';
    }
}

/* Adds a text as one line. */
static void complaint_add(struct mu_text *line, const char *said)
{
    size_t start = line->len;
    for (const char *s = said; *s; s++) {
        bool blank = line->len == start || line->at[line->len - 1] == ' ';
        if (*s != '\n') {
            mu_text_add_bytes(line, s, 1);
        } else if (!blank) {
            mu_text_add(line, " ");
        }
    }
}

void complaint_show(struct mind *m, const char *kind, const char *name)
{
    char bytes[ENVIRONMENT_SAID_MAX];
    struct mu_text line = mu_text_in(bytes, sizeof bytes);
    mu_text_format(&line, "%s %s", kind, name);
    source_lines_add(m, name, &line);
    mu_text_add(&line, ": ");
    syntax_as_written(m->said.at);
    complaint_cut(m->said.at, kind);
    size_t start = line.len;
    complaint_add(&line, m->said.at);
    if (line.len == start) {
        mu_text_format(&line, "stopped%s%s", m->stopped ? " by the guard for " : "",
                       m->stopped ? m->stopped : "");
    }
    if (!complaint_was_shown(m, line.at) && m->options.ports.print) {
        m->options.ports.print(m->options.ports.self, line.at);
        m->options.ports.print(m->options.ports.self, "\n");
    }
    mu_text_clear(&m->said);
}
