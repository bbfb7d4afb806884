/* SPDX-License-Identifier: Apache-2.0 */
/* What our own topics look like, for recordings. */
#include "bus/bus.h"

#include "bus/schema.h"
#include "bus/topics.h"

mu_result bus_schema(enum bus_topic topic, struct mu_text *name, struct mu_text *text)
{
    return schema_write(topic_table[topic].descriptor, name, text);
}

const char *bus_topic_name(enum bus_topic topic)
{
    return topic_table[topic].name;
}
