/* SPDX-License-Identifier: Apache-2.0 */
/* What our own topics look like, for recordings. */
#include "bus/bus.h"

#include "bus/raw/raw.h"
#include "bus/topics.h"

#include <dds/version.h>
#include <string.h>

enum { SCHEMA_BYTES = 64 * 1024, NAME_BYTES = 256 };

mu_result bus_schema(enum bus_topic topic, struct mu_text *name, struct mu_text *text)
{
    return schema_write(topic_table[topic].descriptor, name, text);
}

bool bus_schema_is(enum bus_topic topic, const void *schema, size_t size)
{
    static char bytes[SCHEMA_BYTES];
    char name_bytes[NAME_BYTES];
    struct mu_text name, text;
    mu_text_init(&name, name_bytes, sizeof name_bytes);
    mu_text_init(&text, bytes, sizeof bytes);
    return size == 0 || (bus_schema(topic, &name, &text) == MU_OK && size == text.len &&
                         memcmp(schema, text.at, size) == 0);
}

void bus_profile(enum bus_topic topic, struct mu_text *text)
{
    dds_qos_t *qos = topics_qos(&topic_table[topic]);
    profile_write(qos, text);
    dds_delete_qos(qos);
}

const char *bus_version(void)
{
    return DDS_VERSION;
}

const char *bus_topic_name(enum bus_topic topic)
{
    return topic_table[topic].name;
}
