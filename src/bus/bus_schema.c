/* SPDX-License-Identifier: Apache-2.0 */
/* What our own topics look like, for recordings. */
#include "bus/bus.h"

#include "bus/profile.h"
#include "bus/schema.h"
#include "bus/topics.h"

#include <dds/version.h>

mu_result bus_schema(enum bus_topic topic, struct mu_text *name, struct mu_text *text)
{
    return schema_write(topic_table[topic].descriptor, name, text);
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
