/* SPDX-License-Identifier: Apache-2.0 */
#include "web/web.h"

#include "muster/memory.h"

#include <string.h>

void stream_init(struct stream *o)
{
    *o = (struct stream){.event = mu_startup_alloc(BOARD_EVENT_MAX),
                         .queue = mu_startup_alloc(STREAM_QUEUE_BYTES)};
}

void stream_clear(struct stream *o)
{
    *o = (struct stream){.event = o->event, .queue = o->queue};
}

mu_result stream_put(struct stream *o, const struct mu_text *event)
{
    size_t need = event->len + sizeof event->len;
    if (event->cut || event->len > BOARD_EVENT_MAX || o->queue_len + need > STREAM_QUEUE_BYTES) {
        o->lost++;
        return MU_FULL;
    }
    memcpy(o->queue + o->queue_len, &event->len, sizeof event->len);
    memcpy(o->queue + o->queue_len + sizeof event->len, event->at, event->len);
    o->queue_len += need;
    return MU_OK;
}

/* --- the next event --------------------------------------------------------------------------- */

static void event_set(struct stream *o, const char *bytes, size_t len)
{
    memcpy(o->event, bytes, len);
    o->event_len = len;
    o->event_at = 0;
}

/* What it has missed comes first, so that it reads the rest for what it is. */
static bool losses_take(struct stream *o)
{
    struct mu_json j;
    if (o->missed + o->lost == o->told) {
        return false;
    }
    struct mu_text text = mu_text_in(o->event, BOARD_EVENT_MAX);
    board_event_begin(&text, &j, "missed");
    mu_json_object(&j, NULL);
    mu_json_uint(&j, "frames", o->missed);
    mu_json_uint(&j, "answers", o->lost);
    mu_json_end(&j);
    board_event_end(&text);
    o->event_len = text.len;
    o->event_at = 0;
    o->told = o->missed + o->lost;
    return true;
}

static bool queue_take(struct stream *o)
{
    size_t len;
    if (o->queue_len == 0) {
        return false;
    }
    memcpy(&len, o->queue, sizeof len);
    event_set(o, o->queue + sizeof len, len);
    o->queue_len -= len + sizeof len;
    memmove(o->queue, o->queue + sizeof len + len, o->queue_len);
    return true;
}

static bool is_new(const struct stream *o, const struct board *b, unsigned item)
{
    const struct board_event *e = &b->items[item];
    return e->version != o->seen[item] && e->text.len > 0;
}

/* In turn, so that what comes often leaves room for the rest. */
static bool board_take(struct stream *o, const struct board *b)
{
    for (unsigned n = 0; n < BOARD_ITEMS; n++) {
        unsigned i = (o->turn + n) % BOARD_ITEMS;
        const struct board_event *e = &b->items[i];
        if (!is_new(o, b, i)) {
            continue;
        }
        bool counts = i == BOARD_FRAME && o->seen[i] > 0;
        o->missed += counts ? e->version - o->seen[i] - 1 : 0;
        o->seen[i] = e->version;
        o->turn = i + 1;
        event_set(o, e->text.at, e->text.len);
        return true;
    }
    return false;
}

bool stream_has(const struct stream *o, const struct board *b)
{
    bool has = o->event_at < o->event_len || o->queue_len > 0;
    for (unsigned i = 0; i < BOARD_ITEMS && !has; i++) {
        has = is_new(o, b, i);
    }
    return has;
}

size_t stream_read(struct stream *o, const struct board *b, char *buffer, size_t size)
{
    if (o->event_at == o->event_len && !losses_take(o) && !queue_take(o) && !board_take(o, b)) {
        return 0;
    }
    size_t left = o->event_len - o->event_at;
    size_t len = left < size ? left : size;
    memcpy(buffer, o->event + o->event_at, len);
    o->event_at += len;
    return len;
}
