/* SPDX-License-Identifier: Apache-2.0 */
/* Agents that begin on a host: --robot NAME=FILE, --agent NAME=FILE. */
#include "core/name.h"
#include "core/text.h"
#include "host/host.h"

#include <stdio.h>
#include <string.h>

/* Takes the name off NAME=FILE.  @return the file, or NULL: it is not that */
static const char *native_read(enum mu_kind kind, const char *word, char name[MU_NAME_MAX + 1])
{
    char shown[MU_TEXT_SHOWN];
    const char *equals = strchr(word, '=');
    size_t len = equals ? (size_t)(equals - word) : 0;
    if (len >= 1 && len <= MU_NAME_MAX && equals[1]) {
        memcpy(name, word, len);
        name[len] = '\0';
        if (mu_name_valid(name) && !mu_name_reserved(name)) {
            return equals + 1;
        }
    }
    fprintf(stderr, "muster host --%s %s: expected NAME=FILE\n", mu_kind_text(kind),
            mu_text_show(shown, word));
    return NULL;
}

/* Sets those globals that are for this robot: NAME.G=VALUE. */
static mu_result globals_set(const struct host *h, struct robot *r)
{
    const struct mu_option_list *globals = &h->set->globals;
    size_t len = strlen(r->name);
    mu_result set = MU_OK;
    for (size_t i = 0; i < globals->count && set == MU_OK; i++) {
        const char *word = globals->items[i];
        if (strncmp(word, r->name, len) == 0 && word[len] == '.') {
            set = robot_mind_set_global(r->mind, word + len + 1);
        }
    }
    return set;
}

static mu_result mind_make(struct host *h, struct robot *r, const char *file)
{
    struct mu_fault fault;
    struct mind_options options = robot_mind_options(r, h->folder);
    options.rules_file = file;
    mu_result made = mind_begin(r->mind, &options, &fault);
    made = made == MU_OK ? mind_load(r->mind, file, &fault) : made;
    if (made != MU_OK) {
        mu_fault_print(&fault);
        return made;
    }
    return globals_set(h, r);
}

static bool list_has(const struct mu_option_list *natives, const char *name)
{
    size_t len = strlen(name);
    bool have = false;
    for (size_t i = 0; i < natives->count; i++) {
        have =
            have || (strncmp(natives->items[i], name, len) == 0 && natives->items[i][len] == '=');
    }
    return have;
}

bool natives_have(const struct host *h, const char *name)
{
    return list_has(&h->set->natives, name) || list_has(&h->set->bodiless, name);
}

/* Begins one, unless it comes back from its checkpoint, or is not to. */
static mu_result native_begin(struct host *h, enum mu_kind kind, const char *word, struct robot *r)
{
    const struct checkpoint_options *set = &h->set->robots->checkpoints;
    const char *file = native_read(kind, word, r->name);
    if (!file) {
        return MU_FAULT_USAGE;
    }
    if (set->restore &&
        (checkpoint_is_there(&h->group, r->name) || checkpoint_is_gone(&h->group, r->name))) {
        return MU_OK;
    }
    r->kind = kind;
    robot_state_enter(&r->state, ROBOT_BEGINS);
    checkpoint_set_native(r, true);
    MU_TRY(mind_make(h, r, file));
    return agent_join(r);
}

mu_result natives_begin(struct host *h)
{
    const struct mu_option_list *robots = &h->set->natives, *agents = &h->set->bodiless;
    struct robot *places = h->group.robots;
    if (robots->count + agents->count > h->group.count) {
        fprintf(stderr, "muster host: there is room for %u agents (--agents)\n",
                (unsigned)h->group.count);
        return MU_FAULT_USAGE;
    }
    for (size_t i = 0; i < robots->count; i++) {
        MU_TRY(native_begin(h, MU_KIND_ROBOT, robots->items[i], &places[i]));
    }
    for (size_t i = 0; i < agents->count; i++) {
        MU_TRY(native_begin(h, MU_KIND_AGENT, agents->items[i], &places[robots->count + i]));
    }
    return MU_OK;
}
