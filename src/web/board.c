/* SPDX-License-Identifier: Apache-2.0 */
#include "web/web.h"

#include "muster/memory.h"

#include <string.h>

static const char *const names[BOARD_ITEMS] = {
    [BOARD_RUN] = "run",       [BOARD_SCENE] = "scene",
    [BOARD_FRAME] = "frame",   [BOARD_STATISTICS] = "statistics",
    [BOARD_AGENTS] = "agents", [BOARD_LATER] = "later"};

void board_init(struct board *b)
{
    *b = (struct board){.cut = 0};
    for (int i = 0; i < BOARD_ITEMS; i++) {
        mu_text_init(&b->items[i].text, mu_startup_alloc(BOARD_EVENT_MAX), BOARD_EVENT_MAX);
    }
    mu_text_init(&b->draft, mu_startup_alloc(BOARD_EVENT_MAX), BOARD_EVENT_MAX);
    mu_text_init(&b->scene, mu_startup_alloc(BOARD_SCENE_MAX), BOARD_SCENE_MAX);
}

void board_event_begin(struct mu_text *text, struct mu_json *json, const char *name)
{
    mu_text_format(text, "event: %s\ndata: ", name);
    mu_json_to_text(json, text, MU_JSON_LINE);
}

/* The JSON has ended its line. */
void board_event_end(struct mu_text *text)
{
    mu_text_add(text, "\n");
}

struct mu_json *board_begin(struct board *b, enum board_item item)
{
    b->item = item;
    mu_text_clear(&b->draft);
    board_event_begin(&b->draft, &b->json, names[item]);
    return &b->json;
}

enum board_ended board_end(struct board *b)
{
    struct board_event *e = &b->items[b->item];
    board_event_end(&b->draft);
    if (b->draft.cut) {
        b->cut++;
        return BOARD_CUT;
    }
    if (e->text.len == b->draft.len && memcmp(e->text.at, b->draft.at, b->draft.len) == 0) {
        return BOARD_SAME;
    }
    struct mu_text old = e->text;
    e->text = b->draft;
    b->draft = old;
    e->version++;
    return BOARD_NEW;
}

void board_drop(struct board *b, enum board_item item)
{
    mu_text_clear(&b->items[item].text);
}
