/* SPDX-License-Identifier: Apache-2.0 */
#include "web/web.h"

#include "muster/memory.h"

void viewers_init(struct viewers *v, uint64_t seed)
{
    *v = (struct viewers){.refused = 0};
    mu_random_seed(&v->random, seed, "viewers");
    mu_text_init(&v->event, mu_startup_alloc(VIEWERS_EVENT_MAX), VIEWERS_EVENT_MAX);
    for (size_t i = 0; i < VIEWERS_MAX; i++) {
        stream_init(&v->all[i].stream);
    }
}

struct viewer *viewers_take(struct viewers *v)
{
    for (size_t i = 0; i < VIEWERS_MAX; i++) {
        struct viewer *viewer = &v->all[i];
        if (viewer->used) {
            continue;
        }
        viewer->used = true;
        viewer->id = mu_random_next(&v->random) | 1u; /* 0 is none */
        viewer->connection = NULL;
        viewer->sleeps = false;
        stream_clear(&viewer->stream);
        return viewer;
    }
    v->refused++;
    return NULL;
}

void viewers_release(struct viewer *viewer)
{
    viewer->used = false;
    viewer->connection = NULL;
}

bool viewers_have_room(const struct viewers *v)
{
    for (size_t i = 0; i < VIEWERS_MAX; i++) {
        if (!v->all[i].used) {
            return true;
        }
    }
    return false;
}

struct viewer *viewers_find(struct viewers *v, uint64_t id)
{
    for (size_t i = 0; i < VIEWERS_MAX; i++) {
        if (v->all[i].used && v->all[i].id == id) {
            return &v->all[i];
        }
    }
    return NULL;
}

struct mu_json *viewers_begin(struct viewers *v, const char *name)
{
    mu_text_clear(&v->event);
    board_event_begin(&v->event, &v->json, name);
    return &v->json;
}

void viewers_end(struct viewers *v)
{
    board_event_end(&v->event);
}

void viewers_send(struct viewers *v, struct viewer *to)
{
    (void)stream_put(&to->stream, &v->event);
}
