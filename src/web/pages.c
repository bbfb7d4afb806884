/* SPDX-License-Identifier: Apache-2.0 */
#include "web/json.h"

#include "core/name.h"
#include "core/text.h"

#include <stdio.h>
#include <string.h>

void pages_init(struct pages *p)
{
    mu_table_init(&p->names, PAGES_LINES_MAX);
}

static struct pages_line *line_place(struct pages *p, const char *name)
{
    uint32_t at = mu_table_find(&p->names, name);
    for (uint32_t i = 0; at == MU_NONE && i < PAGES_LINES_MAX; i++) {
        at = p->lines[i].name[0] ? MU_NONE : i;
    }
    if (at == MU_NONE) {
        return NULL;
    }
    struct pages_line *line = &p->lines[at];
    if (!line->name[0]) {
        mu_text_copy(line->name, sizeof line->name, name);
        mu_table_put(&p->names, line->name, at);
        p->count = at + 1 > p->count ? at + 1 : p->count;
    }
    return line;
}

/* name kind state broker process host pid since_wall_ns reason */
static void line_take(struct pages *p, const muster_Page *page, const char *text)
{
    char name[MU_NAME_MAX + 1], kind[PAGES_WORD_MAX + 1], state[PAGES_WORD_MAX + 1];
    char host[MU_FIELD_MAX + 1];
    int behind = 0;
    bool whole = sscanf(text, "%31s %15s %15s %*s %*s %63s %*s %*s %n", name, kind, state, host,
                        &behind) == 4 &&
                 mu_name_valid(name);
    struct pages_line *line = whole ? line_place(p, name) : NULL;
    if (!line) {
        p->refused++;
        return;
    }
    mu_text_copy(line->kind, sizeof line->kind, kind);
    mu_text_copy(line->state, sizeof line->state, state);
    mu_text_copy(line->host, sizeof line->host, strcmp(host, "-") == 0 ? "" : host);
    mu_text_copy(line->reason, sizeof line->reason, behind > 0 ? text + behind : "");
    mu_text_copy(line->broker, sizeof line->broker, page->broker);
    line->part = page->part;
    line->turn = p->turn;
}

void pages_take(struct pages *p, const muster_Page *page)
{
    p->turn++;
    for (uint32_t i = 0; i < page->lines._length; i++) {
        line_take(p, page, page->lines._buffer[i]);
    }
    for (uint32_t i = 0; i < p->count; i++) {
        struct pages_line *line = &p->lines[i];
        bool theirs = line->part == page->part && strcmp(line->broker, page->broker) == 0;
        if (line->name[0] && theirs && line->turn != p->turn) {
            mu_table_remove(&p->names, line->name);
            line->name[0] = '\0';
        }
    }
}

void pages_write(struct mu_json *j, const struct pages *p)
{
    mu_json_object(j, NULL);
    mu_json_list(j, "agents");
    for (uint32_t i = 0; i < p->count; i++) {
        const struct pages_line *line = &p->lines[i];
        if (!line->name[0] || mu_name_of_operator(line->name)) {
            continue;
        }
        mu_json_list(j, NULL);
        mu_json_string(j, NULL, line->name);
        mu_json_string(j, NULL, line->kind);
        mu_json_string(j, NULL, line->state);
        mu_json_string(j, NULL, line->host);
        mu_json_string(j, NULL, line->reason);
        mu_json_end(j);
    }
    mu_json_end(j);
    mu_json_end(j);
}
