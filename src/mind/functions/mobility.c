/* SPDX-License-Identifier: Apache-2.0 */
/* (moveTo), (clone), (dispose): where a mind is to go when its step is over. */
#include "core/name.h"
#include "core/text.h"
#include "mind/engine/value.h"
#include "mind/functions/table.h"

/* The name that an argument is.  @return false: it is none, and the call has ended in an error */
static bool name_take(void *env, const char *function, int index, char name[MU_NAME_MAX + 1])
{
    const char *word;
    if (!clips_value_word(env, function, index, &word)) {
        return false;
    }
    if (!mu_name_valid(word) || mu_name_reserved(word)) {
        clips_value_refuse(env, function, "a name");
        return false;
    }
    return mu_text_copy(name, MU_NAME_MAX + 1, word);
}

static void travel_set(void *env, struct mind_travel w, DATA_OBJECT *out)
{
    struct mind *m = clips_env_mind(env);
    bool first = m->travel.kind == MIND_STAYS;
    if (first) {
        m->travel = w;
    }
    clips_value_bool(env, out, first);
}

void clips_mobility_move(void *env, DATA_OBJECT *out)
{
    struct mind_travel w = {.kind = MIND_MOVES};
    clips_value_bool(env, out, false);
    if (name_take(env, "moveTo", 1, w.host)) {
        travel_set(env, w, out);
    }
}

void clips_mobility_clone(void *env, DATA_OBJECT *out)
{
    struct mind_travel w = {.kind = MIND_CLONES};
    clips_value_bool(env, out, false);
    if (!name_take(env, "clone", 1, w.name)) {
        return;
    }
    if (EnvRtnArgCount(env) < 2 || name_take(env, "clone", 2, w.host)) {
        travel_set(env, w, out);
    }
}

void clips_mobility_dispose(void *env, DATA_OBJECT *out)
{
    travel_set(env, (struct mind_travel){.kind = MIND_DISPOSES}, out);
}

struct mind_travel mind_travel(struct mind *m)
{
    struct mind_travel w = m->travel;
    m->travel = (struct mind_travel){.kind = MIND_STAYS};
    return w;
}
