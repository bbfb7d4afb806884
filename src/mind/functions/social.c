/* SPDX-License-Identifier: Apache-2.0 */
/* What rules ask about themselves and the other agents. */
#include "mind/engine/value.h"
#include "mind/functions/table.h"

#include <string.h>

void clips_social_my_name(void *env, DATA_OBJECT *out)
{
    clips_value_symbol(env, out, clips_env_mind(env)->options.name);
}

void clips_social_lookup(void *env, DATA_OBJECT *out)
{
    const struct mind_ports *ports = &clips_env_mind(env)->options.ports;
    struct mind_member member;
    const char *name;
    clips_value_bool(env, out, false);
    if (!clips_value_word(env, "lookup", 1, &name) || !ports->lookup ||
        ports->lookup(ports->self, name, &member) != MU_OK) {
        return;
    }
    struct multifield *fields = EnvCreateMultifield(env, 4);
    clips_value_set_symbol(env, fields, 0, member.name);
    clips_value_set_symbol(env, fields, 1, member.kind);
    clips_value_set_symbol(env, fields, 2, member.state);
    clips_value_set_word(env, fields, 3, member.host);
    clips_value_multifield(out, fields);
}

void clips_social_listing(void *env, DATA_OBJECT *out)
{
    const struct mind_ports *ports = &clips_env_mind(env)->options.ports;
    struct mind_member member;
    size_t count = 0;
    while (ports->listing && ports->listing(ports->self, count, &member) == MU_OK) {
        count++;
    }
    struct multifield *fields = EnvCreateMultifield(env, (long)count);
    for (size_t i = 0; i < count; i++) {
        bool there = ports->listing(ports->self, i, &member) == MU_OK;
        clips_value_set_symbol(env, fields, i, there ? member.name : "nil");
    }
    clips_value_multifield(out, fields);
}
