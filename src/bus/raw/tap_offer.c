/* SPDX-License-Identifier: Apache-2.0 */
/* What recordings say of a topic beside its samples: type, partitions, quality of service. */
#include "bus/raw/raw.h"
#include "bus/topics.h"

#include <string.h>

static const dds_duration_t TYPE_NS = 200000000;

/* Names that do not fit as a whole are left out. */
static void partitions_write(const dds_qos_t *qos, struct tap_offer *offer)
{
    uint32_t count = 0;
    char **names = NULL;
    struct mu_text lines = mu_text_in(offer->partitions, sizeof offer->partitions);
    if (!dds_qget_partition(qos, &count, &names)) {
        return;
    }
    for (uint32_t i = 0; i < count; i++) {
        if (lines.len + strlen(names[i]) + 1 < lines.size) {
            mu_text_add(&lines, i > 0 ? "\n" : "");
            mu_text_add(&lines, names[i]);
        }
        dds_free(names[i]);
    }
    dds_free(names);
}

bool tap_offer(const struct tap *tap, uint64_t writer, struct tap_offer *offer)
{
    dds_builtintopic_endpoint_t *e = dds_get_matched_publication_data(tap->reader, writer);
    offer->partitions[0] = offer->words[0] = '\0';
    if (e && e->qos) {
        partitions_write(e->qos, offer);
    }
    if (e && e->qos && !tap->ours) {
        struct mu_text words = mu_text_in(offer->words, sizeof offer->words);
        offer_write(e->qos, &words);
    }
    if (e) {
        dds_builtintopic_free_endpoint(e);
    }
    return e != NULL;
}

/* Asks for the type of a topic that is open.  @return NULL: no process says it */
static dds_topic_descriptor_t *foreign_type(const struct tap *tap)
{
    dds_typeinfo_t *info = NULL;
    dds_topic_descriptor_t *descriptor = NULL;
    if (dds_get_typeinfo(tap->topic, &info) != DDS_RETCODE_OK || !info) {
        return NULL;
    }
    dds_entity_t participant = dds_get_participant(tap->topic);
    dds_return_t got =
        dds_create_topic_descriptor(DDS_FIND_SCOPE_GLOBAL, participant, info, TYPE_NS, &descriptor);
    (void)dds_free_typeinfo(info);
    return got == DDS_RETCODE_OK ? descriptor : NULL;
}

mu_result tap_schema(const struct tap *tap, struct mu_text *name, struct mu_text *text)
{
    const struct topic *ours = topics_find(tap->name, tap->type);
    if (ours) {
        return schema_write(ours->descriptor, name, text);
    }
    dds_topic_descriptor_t *descriptor = foreign_type(tap);
    if (!descriptor) {
        return MU_ABSENT;
    }
    mu_result written = schema_write(descriptor, name, text);
    dds_delete_topic_descriptor(descriptor);
    return written;
}

size_t tap_type(const struct tap *tap, void *to, size_t size, struct mu_text *name)
{
    char hash[TYPE_HASH_MAX] = "";
    dds_topic_descriptor_t *descriptor = tap->ours ? NULL : foreign_type(tap);
    if (!descriptor) {
        return 0;
    }
    size_t bytes = type_bytes_write(descriptor, to, size, hash);
    dds_delete_topic_descriptor(descriptor);
    mu_text_format(name, "%s-%s", tap->type, hash);
    return bytes;
}

void tap_profile(const struct tap *tap, const struct tap_offer *offer, struct mu_text *text)
{
    const struct topic *ours = topics_find(tap->name, tap->type);
    dds_qos_t *qos = ours ? topics_qos(ours) : dds_create_qos();
    if (!ours) {
        offer_read(offer->words, qos);
    }
    profile_write(qos, text);
    dds_delete_qos(qos);
}
