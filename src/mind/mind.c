/* SPDX-License-Identifier: Apache-2.0 */
/* A mind is made, loaded, saved and restored. */
#include "mind/mind.h"
#include "core/name.h"

#include "mind/snapshot/snapshot.h"
#include "muster/memory.h"

#include <stdio.h>
#include <string.h>

/*
 * CLIPS calls this after each rule: one that called (update-sensors) or (moveTo) is the last of the
 * step.
 */
static void mind_after_rule(void *env)
{
    const struct mind *m = environment_mind(env);
    if (output_of(m)->sense_again || output_of(m)->travel.kind != MIND_STAYS) {
        EnvHalt(env);
    }
}

static void env_install(struct mind *m)
{
    environment_install(m);
    percept_install(m);
    timers_install(m);
    budget_install(m);
    builtins_install(m);
    functions_install(m);
    load_install(m);
    EnvAddRunFunction(m->env, "mu-step", mind_after_rule, 0);
    trace_install(m);
    meter_install(m);
}

static mu_result env_load_library(struct mind *m, struct mu_fault *fault)
{
    if (!m->options.rules_folder) {
        return MU_OK;
    }
    char path[MU_FAULT_FILE_MAX + 1];
    snprintf(path, sizeof path, "%s/muster.clp", m->options.rules_folder);
    mu_result loaded = load_file(m, path, fault);
    output_of(m)->rules_speak = false;
    return loaded;
}

struct mind *mind_reserve(void)
{
    struct mind_loader *whole = mu_startup_alloc(sizeof *whole);
    struct mind *m = &whole->output.inputs.mind;
    facts_reserve(m);
    load_reserve(m);
    return m;
}

/* Forgets an earlier mind in this memory; the memory stays. */
static void env_clear(struct mind *m)
{
    const struct mind_inputs *in = inputs_of(m);
    const struct mind_loader before = {.output.inputs = {.mind.source_lines = m->source_lines,
                                                         .messages = in->messages,
                                                         .mail_ring = in->mail_ring,
                                                         .scratch = in->scratch},
                                       .text = loader_of(m)->text,
                                       .form = loader_of(m)->form};
    *loader_of(m) = before;
}

static mu_result env_take_options(struct mind *m, const struct mind_options *options,
                                  struct mu_fault *fault)
{
    if (!mu_name_valid(options->name)) {
        return mu_fault_at(fault, "", 0, 0, "'%s' is no name for an agent", options->name);
    }
    m->options = *options;
    (void)mu_text_copy(m->name, sizeof m->name, options->name);
    m->options.name = m->name;
    if (options->rules_folder) {
        if (!mu_text_copy(m->folder, sizeof m->folder, options->rules_folder)) {
            return mu_fault_at(fault, "", 0, 0, "the path of the shared rules is too long");
        }
        m->options.rules_folder = m->folder;
    }
    if (options->rules_file) {
        if (!mu_text_copy(m->file, sizeof m->file, options->rules_file)) {
            return mu_fault_at(fault, "", 0, 0, "the path of the rules is too long");
        }
        m->options.rules_file = m->file;
    }
    if (m->options.firings_max == 0) {
        m->options.firings_max = MU_FIRINGS_PER_STEP;
    }
    return MU_OK;
}

mu_result mind_begin(struct mind *m, const struct mind_options *options, struct mu_fault *fault)
{
    MU_ASSERT(!state_has_rules(m));
    env_clear(m);
    MU_TRY(env_take_options(m, options, fault));
    mu_text_init(&m->fired, m->fired_bytes, sizeof m->fired_bytes);
    mu_text_init(&m->said, m->said_bytes, sizeof m->said_bytes);
    mu_random_seed(&output_of(m)->random, options->seed, m->options.name);
    heap_make(m);
    env_install(m);
    if (!MIND_ENTER(m, STATE_BEGIN)) {
        return mu_fault_at(fault, "", 0, 0, CLIPS_BROKEN_TEXT, m->lost);
    }
    bool built = environment_build(m) && facts_build(m);
    MU_ASSERT(!environment_end(m) && built);
    mailbox_install(m);
    mu_result loaded = env_load_library(m, fault);
    (void)mind_leave(m);
    return loaded;
}

mu_result mind_open(struct mind **out, const struct mind_options *options, struct mu_fault *fault)
{
    if (!mu_name_valid(options->name)) {
        return mu_fault_at(fault, "", 0, 0, "'%s' is no name for an agent", options->name);
    }
    *out = mind_reserve();
    return mind_begin(*out, options, fault);
}

bool mind_is_broken(const struct mind *m)
{
    return m->state == MIND_FAILED;
}

void mind_close(struct mind *m)
{
    if (m && state_has_rules(m)) {
        heap_drop(m);
    }
    if (m) {
        (void)state_on(m, STATE_CLOSE);
    }
}

struct mind_travel mind_travel(struct mind *m)
{
    struct mind_travel w = output_of(m)->travel;
    output_of(m)->travel = (struct mind_travel){.kind = MIND_STAYS};
    return w;
}

void mind_forgive(struct mind *m)
{
    failures_clear(m);
}

enum mind_wish mind_wish(struct mind *m, uint32_t *rules)
{
    enum mind_wish wish = output_of(m)->wish;
    *rules = output_of(m)->wish_rules;
    output_of(m)->wish = MIND_WISH_NOTHING;
    return wish;
}

void mind_go_on(struct mind *m)
{
    output_of(m)->passes = output_of(m)->stands[0] != '\0';
}

bool mind_speaks(const struct mind *m)
{
    return output_of(m)->rules_speak;
}

uint32_t mind_senses(const struct mind *m)
{
    return sensors_wanted(m);
}

mu_result mind_load(struct mind *m, const char *path, struct mu_fault *fault)
{
    if (!MIND_ENTER(m, STATE_LOAD)) {
        return mu_fault_at(fault, path, 0, 0, CLIPS_BROKEN_TEXT, m->lost);
    }
    failures_clear(m);
    mu_result r = load_file(m, path, fault);
    r = r == MU_OK ? load_begin(m, path, fault) : r;
    (void)mind_leave(m);
    return r;
}

mu_result mind_load_text(struct mind *m, const char *name, const char *text, struct mu_fault *fault)
{
    if (!MIND_ENTER(m, STATE_LOAD)) {
        return mu_fault_at(fault, name, 0, 0, CLIPS_BROKEN_TEXT, m->lost);
    }
    failures_clear(m);
    mu_result r = load_text(m, name, text, fault);
    r = r == MU_OK ? load_begin(m, name, fault) : r;
    (void)mind_leave(m);
    return r;
}

mu_result mind_save(struct mind *m, struct mu_text *out, struct mu_fault *fault)
{
    if (!MIND_ENTER(m, STATE_SAVE)) {
        (void)mu_fault_at(fault, "capsule", 0, 0, CLIPS_BROKEN_TEXT, m->lost);
        return MU_REFUSED;
    }
    mu_result r = snapshot_save(m, out, fault);
    (void)mind_leave(m);
    return r;
}

/* Adds a field as text that reads back.  @return false: it is not exactly one field */
static bool line_field(const char *field, struct mu_text *out)
{
    const char *rest = field;
    struct syntax_field f = syntax_read_field(&rest);
    struct syntax_field more = syntax_read_field(&rest);
    if (f.kind == SYNTAX_FIELD_END || f.kind == SYNTAX_FIELD_BAD || more.kind != SYNTAX_FIELD_END) {
        return false;
    }
    if (f.kind == SYNTAX_FIELD_SYMBOL) {
        char word[256];
        if (f.len >= sizeof word) {
            return false;
        }
        memcpy(word, f.at, f.len);
        word[f.len] = '\0';
        syntax_add_symbol(out, word);
    } else {
        mu_text_add(out, field);
    }
    return !out->cut;
}

/* Redefines the global, so that (reset) keeps the value. */
mu_result mind_set_global(struct mind *m, const char *name, const char *field)
{
    char bytes[512];
    DATA_OBJECT value;
    struct mu_text build = mu_text_in(bytes, sizeof bytes);
    if (!state_has_rules(m)) {
        return MU_MALFORMED;
    }
    if (!EnvGetDefglobalValue(m->env, name, &value)) {
        return MU_ABSENT;
    }
    mu_text_format(&build, "(defglobal ?*%s* = ", name);
    if (!line_field(field, &build)) {
        return MU_MALFORMED;
    }
    mu_text_add(&build, ")");
    if (!MIND_ENTER(m, STATE_LOAD)) {
        return MU_MALFORMED;
    }
    bool built = EnvBuild(m->env, build.at);
    return mind_leave(m) || !built || build.cut ? MU_MALFORMED : MU_OK;
}

/* Gives a copy its own name. */
static mu_result name_set(struct mind *m, const char *was)
{
    if (strcmp(was, m->options.name) == 0) {
        return MU_OK;
    }
    return mind_set_global(m, "my-name", m->options.name);
}

mu_result mind_restore(struct mind *m, const char *snapshot, size_t len, struct mu_fault *fault)
{
    char name[MU_NAME_MAX + 1];
    MU_TRY(snapshot_check(snapshot, len, fault));
    if (!MIND_ENTER(m, STATE_LOAD)) {
        return mu_fault_at(fault, "capsule", 0, 0, CLIPS_BROKEN_TEXT, m->lost);
    }
    mu_result r = snapshot_load(m, snapshot, fault, name);
    (void)mind_leave(m);
    return r == MU_OK ? name_set(m, name) : r;
}

void mind_trace(struct mind *m, struct mu_text *out)
{
    mu_text_add_bytes(out, m->trace.at, m->trace.len);
    if (m->trace_lost > 0) {
        mu_text_format(out, "~ %u\n", m->trace_lost);
    }
    m->trace_lost = 0;
    mu_text_clear(&m->trace);
}
