/* SPDX-License-Identifier: Apache-2.0 */
/* Lines that are set aside, as rules and people at a console see them. */
#include "mind/engine/value.h"
#include "mind/functions/table.h"

void clips_aside_list(void *env, DATA_OBJECT *out)
{
    const struct mind_ports *ports = &clips_env_mind(env)->options.ports;
    size_t count = 0;
    while (ports->aside && ports->aside(ports->self, count)) {
        count++;
    }
    struct multifield *fields = EnvCreateMultifield(env, (long)count);
    for (size_t i = 0; i < count; i++) {
        fields->theFields[i].type = STRING;
        fields->theFields[i].value = EnvAddSymbol(env, ports->aside(ports->self, i));
    }
    clips_value_multifield(out, fields);
}

void clips_aside_drop(void *env, DATA_OBJECT *out)
{
    const struct mind_ports *ports = &clips_env_mind(env)->options.ports;
    long long number;
    clips_value_bool(env, out, false);
    if (clips_value_whole(env, "drop-aside", 1, &number) && number > 0 && ports->drop_aside) {
        clips_value_bool(env, out, ports->drop_aside(ports->self, (size_t)number - 1));
    }
}
