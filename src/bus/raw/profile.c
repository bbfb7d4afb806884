/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/raw/raw.h"

static const int64_t SECOND_NS = 1000000000;

/* Without an end is the largest time that an rmw has. */
static void duration_write(struct mu_text *text, const char *name, dds_duration_t ns)
{
    long long all = ns == DDS_INFINITY ? INT64_MAX : ns;
    mu_text_format(text, "  %s:\n    sec: %lld\n    nsec: %lld\n", name, all / SECOND_NS,
                   all % SECOND_NS);
}

void profile_write(const dds_qos_t *qos, struct mu_text *text)
{
    dds_history_kind_t history = DDS_HISTORY_KEEP_LAST;
    int32_t depth = 1;
    dds_reliability_kind_t reliability = DDS_RELIABILITY_RELIABLE;
    dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
    dds_liveliness_kind_t liveliness = DDS_LIVELINESS_AUTOMATIC;
    dds_duration_t lease = DDS_INFINITY, deadline = DDS_INFINITY, lifespan = DDS_INFINITY;
    (void)dds_qget_history(qos, &history, &depth);
    (void)dds_qget_reliability(qos, &reliability, NULL);
    (void)dds_qget_durability(qos, &durability);
    (void)dds_qget_liveliness(qos, &liveliness, &lease);
    (void)dds_qget_deadline(qos, &deadline);
    (void)dds_qget_lifespan(qos, &lifespan);
    mu_text_format(text, "- history: %d\n  depth: %d\n  reliability: %d\n  durability: %d\n",
                   history == DDS_HISTORY_KEEP_ALL ? 2 : 1, (int)depth,
                   reliability == DDS_RELIABILITY_RELIABLE ? 1 : 2,
                   durability >= DDS_DURABILITY_TRANSIENT_LOCAL ? 1 : 2);
    duration_write(text, "deadline", deadline);
    duration_write(text, "lifespan", lifespan);
    mu_text_format(text, "  liveliness: %d\n", (int)liveliness + 1);
    duration_write(text, "liveliness_lease_duration", lease);
    mu_text_add(text, "  avoid_ros_namespace_conventions: true\n");
}
