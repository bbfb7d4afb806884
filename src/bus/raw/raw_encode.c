/* SPDX-License-Identifier: Apache-2.0 */
/* Samples as bytes, by the very tables that DDS writes them with. */
#include "bus/bus.h"
#include "bus/raw/raw.h"
#include "bus/topics.h"

#include <string.h>

/* DDS's own headers want a word that C11 does not have. */
#define asm __asm__
#include <dds/ddsi/ddsi_cdrstream.h>

/* "CDR_LE" (RTPS 2.2, 10.2.1.2): version 1, little-endian, whatever the machine, no options. */
enum { CDR_VERSION = 1 };
static const unsigned char CDR_HEAD[4] = {0, 1, 0, 0};

mu_result bus_encode(enum bus_topic topic, const void *sample, struct bus_bytes *to)
{
    /* The head lies before the first place that suits all types, as alignment counts from there. */
    enum { BODY = 8, HEAD = BODY - sizeof CDR_HEAD };
    dds_ostreamLE_t out = {.x = {to->room, to->room_size, 0, CDR_VERSION}};
    if (!to->room) {
        dds_ostreamLE_init(&out, BODY, CDR_VERSION);
    }
    out.x.m_index = BODY;
    bool whole = dds_stream_writeLE(&out, sample, topic_table[topic].descriptor->m_ops) != NULL;
    memcpy(out.x.m_buffer + HEAD, CDR_HEAD, sizeof CDR_HEAD);
    *to = (struct bus_bytes){.data = out.x.m_buffer + HEAD,
                             .size = out.x.m_index - HEAD,
                             .room = out.x.m_buffer,
                             .room_size = out.x.m_size};
    return whole ? MU_OK : MU_MALFORMED;
}

void bus_bytes_free(struct bus_bytes *bytes)
{
    dds_free(bytes->room);
    *bytes = (struct bus_bytes){0};
}

mu_result bus_decode(enum bus_topic topic, void *bytes, size_t size, void **sample)
{
    const struct topic *t = &topic_table[topic];
    const uint32_t *ops = t->descriptor->m_ops;
    const unsigned char *head = bytes;
    char *body = (char *)bytes + sizeof CDR_HEAD;
    uint32_t read = 0;
    *sample = NULL;
    /* Two bytes of options stand behind the kind: how much of the end is padding. */
    if (size < sizeof CDR_HEAD || size > UINT32_MAX || head[0] != 0 || head[1] > 1) {
        return MU_MALFORMED;
    }
    uint32_t left = (uint32_t)(size - sizeof CDR_HEAD);
    bool swap = (head[1] == 1) != (DDSRT_ENDIAN == DDSRT_LITTLE_ENDIAN);
    if (!dds_stream_normalize_data(body, &read, left, swap, CDR_VERSION, ops)) {
        return MU_MALFORMED;
    }
    dds_istream_t in;
    dds_istream_init(&in, left, body, CDR_VERSION);
    *sample = dds_alloc(t->descriptor->m_size);
    memset(*sample, 0, t->descriptor->m_size); /* reading would use again what is there */
    (void)dds_stream_read(&in, *sample, ops);
    if (!t->check(*sample)) {
        bus_decode_free(topic, *sample);
        *sample = NULL;
        return MU_MALFORMED;
    }
    return MU_OK;
}

void bus_decode_free(enum bus_topic topic, void *sample)
{
    if (sample) {
        dds_stream_free_sample(sample, topic_table[topic].descriptor->m_ops);
        dds_free(sample);
    }
}
