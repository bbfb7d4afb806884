/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/raw/raw.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

/* DDS's own headers want a word that C11 does not have. */
#define asm __asm__
#include <dds/ddsi/ddsi_xqos.h>

#include <dds/ddsi/ddsi_cdrstream.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/ddsi_typelib.h>
#include <dds/ddsi/ddsi_typewrap.h>
#include <dds/ddsi/ddsi_xt_impl.h>
#include <dds/ddsi/ddsi_xt_typemap.h>

enum { LENGTH_BYTES = 4, HASH_BYTES = 14, CDR_VERSION = 2, LOOK_S = 5 };

typedef struct ddsi_sertype_cdr_data cdr_bytes;

/* --- writing ---------------------------------------------------------------------------------- */

static void hash_write(const ddsi_typeinfo_t *info, char hash[TYPE_HASH_MAX])
{
    DDS_XTypes_EquivalenceHash bytes;
    ddsi_typeid_get_equivalence_hash(ddsi_typeinfo_complete_typeid(info), &bytes);
    for (size_t i = 0; i < HASH_BYTES; i++) {
        snprintf(hash + 2 * i, 3, "%02x", bytes[i]);
    }
}

static bool is_described(const dds_topic_descriptor_t *d)
{
    return (d->m_flagset & DDS_TOPIC_XTYPES_METADATA) && d->type_information.sz > 0 &&
           d->type_mapping.sz > 0;
}

size_t type_bytes_write(const dds_topic_descriptor_t *d, void *to, size_t size,
                        char hash[TYPE_HASH_MAX])
{
    size_t info_size = d->type_information.sz, map_size = d->type_mapping.sz;
    unsigned char *at = to;
    if (!is_described(d) || size < LENGTH_BYTES + info_size + map_size) {
        return 0;
    }
    /* Nothing is written through it. */
    cdr_bytes info_bytes = {d->type_information.sz, (uint8_t *)(uintptr_t)d->type_information.data};
    ddsi_typeinfo_t *info = ddsi_typeinfo_deser(&info_bytes);
    if (!info) {
        return 0;
    }
    hash_write(info, hash);
    ddsi_typeinfo_fini(info);
    dds_free(info);
    for (size_t i = 0; i < LENGTH_BYTES; i++) {
        at[i] = (unsigned char)(info_size >> (8 * i));
    }
    memcpy(at + LENGTH_BYTES, d->type_information.data, info_size);
    memcpy(at + LENGTH_BYTES + info_size, d->type_mapping.data, map_size);
    return LENGTH_BYTES + info_size + map_size;
}

/* --- topics ----------------------------------------------------------------------------------- */

dds_entity_t type_topic(dds_entity_t participant, const dds_topic_descriptor_t *d, const char *name)
{
    union {
        dds_topic_descriptor_t d;
        char bytes[sizeof(dds_topic_descriptor_t)]; /* its members are const */
    } copy;
    uint32_t flags = d->m_flagset & ~(uint32_t)(DDS_TOPIC_FIXED_KEY | DDS_TOPIC_FIXED_KEY_XCDR2);
    memcpy(copy.bytes, d, sizeof copy);
    memcpy(copy.bytes + offsetof(dds_topic_descriptor_t, m_flagset), &flags, sizeof flags);
    return dds_create_topic(participant, &copy.d, name, NULL, NULL);
}

/* --- reading ---------------------------------------------------------------------------------- */

/* What DDS asks a type for when it takes its description in; it looks at nothing else of it. */
struct described {
    struct ddsi_sertype type;
    cdr_bytes info, map;
};

static ddsi_typeinfo_t *described_info(const struct ddsi_sertype *type)
{
    return ddsi_typeinfo_deser(&((const struct described *)(const void *)type)->info);
}

static ddsi_typemap_t *described_map(const struct ddsi_sertype *type)
{
    return ddsi_typemap_deser(&((const struct described *)(const void *)type)->map);
}

static const struct ddsi_sertype_ops described_ops = {
    .version = ddsi_sertype_v0, .type_info = described_info, .type_map = described_map};

/* DDS reads these bytes without a look at where they end: here is one. */
static bool is_whole(const cdr_bytes *bytes, const dds_topic_descriptor_t *of)
{
    uint32_t read = 0;
    bool swap = DDSRT_ENDIAN != DDSRT_LITTLE_ENDIAN;
    return bytes->sz > 0 && dds_stream_normalize_data((char *)bytes->data, &read, bytes->sz, swap,
                                                      CDR_VERSION, of->m_ops);
}

static bool is_hashed(const DDS_XTypes_TypeIdentifier *id, const DDS_XTypes_TypeObject *object)
{
    DDS_XTypes_TypeIdentifier own;
    bool known = object->_d == DDS_XTypes_EK_COMPLETE || object->_d == DDS_XTypes_EK_MINIMAL;
    if (!known || id->_d != object->_d) {
        return false;
    }
    ddsi_typeobj_get_hash_id_impl(object, &own);
    return own._d == id->_d &&
           memcmp(own._u.equivalence_hash, id->_u.equivalence_hash, HASH_BYTES) == 0;
}

static bool all_hashed(const dds_sequence_DDS_XTypes_TypeIdentifierTypeObjectPair *pairs)
{
    bool good = pairs->_length > 0;
    for (uint32_t i = 0; i < pairs->_length && good; i++) {
        good = is_hashed(&pairs->_buffer[i].type_identifier, &pairs->_buffer[i].type_object);
    }
    return good;
}

typedef dds_sequence_DDS_XTypes_TypeIdentifierTypeObjectPair objects;

static bool has_object(const objects *all, const DDS_XTypes_TypeIdentifierWithSize *id)
{
    for (uint32_t i = 0; i < all->_length; i++) {
        if (ddsi_typeid_compare_impl(&all->_buffer[i].type_identifier, &id->type_id) == 0) {
            return true;
        }
    }
    return false;
}

/* What DDS knows of a type already would suffer from a list of others that are not there. */
static bool all_there(const objects *all, const DDS_XTypes_TypeIdentifierWithDependencies *of)
{
    bool good = has_object(all, &of->typeid_with_size) &&
                of->dependent_typeids._length < INT32_MAX &&
                of->dependent_typeid_count == (int32_t)of->dependent_typeids._length;
    for (uint32_t i = 0; i < of->dependent_typeids._length && good; i++) {
        good = has_object(all, &of->dependent_typeids._buffer[i]);
    }
    return good;
}

static bool map_is_good(const struct described *d, const ddsi_typeinfo_t *info)
{
    ddsi_typemap_t *map = described_map(&d->type);
    bool good = map && all_hashed(&map->x.identifier_object_pair_complete) &&
                all_hashed(&map->x.identifier_object_pair_minimal) &&
                all_there(&map->x.identifier_object_pair_complete, &info->x.complete) &&
                all_there(&map->x.identifier_object_pair_minimal, &info->x.minimal);
    if (map) {
        ddsi_typemap_fini(map);
        dds_free(map);
    }
    return good;
}

/* Takes bytes apart; they are the caller's, in a place that suits all numbers. */
static bool described_read(struct described *d, unsigned char *bytes, size_t size)
{
    size_t info = 0;
    for (size_t i = LENGTH_BYTES; size > LENGTH_BYTES && i > 0; i--) {
        info = info << 8 | bytes[i - 1];
    }
    if (info == 0 || size > UINT32_MAX || info >= size - LENGTH_BYTES) {
        return false;
    }
    *d = (struct described){.type = {.ops = &described_ops},
                            .info = {(uint32_t)info, bytes + LENGTH_BYTES},
                            .map = {(uint32_t)(size - LENGTH_BYTES - info), NULL}};
    return is_whole(&d->info, &DDS_XTypes_TypeInformation_desc);
}

/* The domain as DDS itself knows it is in no interface, but in every type that it has made. */
static struct ddsi_domaingv *domain_of(dds_entity_t participant)
{
    struct ddsi_domaingv *gv = NULL;
    struct ddsi_serdata *data[1];
    dds_sample_info_t info[1];
    dds_entity_t reader =
        dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, NULL, NULL);
    if (reader > 0 && dds_readcdr(reader, data, 1, info, DDS_ANY_STATE) == 1) { /* ourselves */
        gv = ddsrt_atomic_ldvoidp(&data[0]->type->gv);
        ddsi_serdata_unref(data[0]);
    }
    (void)dds_delete(reader);
    return gv;
}

/* @return whether the description has a top that is known by its hash */
static bool info_is_good(const ddsi_typeinfo_t *info)
{
    return info && ddsi_typeid_is_hash(ddsi_typeinfo_complete_typeid(info)) &&
           ddsi_typeid_is_complete(ddsi_typeinfo_complete_typeid(info)) &&
           ddsi_typeid_is_hash(ddsi_typeinfo_minimal_typeid(info));
}

/* Makes DDS know the type as if a program had told it, for as long as it takes to describe it. */
static mu_result type_learn(dds_entity_t participant, const struct described *d,
                            const ddsi_typeinfo_t *info, dds_topic_descriptor_t **descriptor)
{
    struct ddsi_domaingv *gv = domain_of(participant);
    struct ddsi_type *known = NULL;
    if (!gv) {
        return MU_FAULT_DDS;
    }
    if (ddsi_type_ref_local(gv, &known, &d->type, DDSI_TYPEID_KIND_COMPLETE) != DDS_RETCODE_OK) {
        return MU_MALFORMED;
    }
    bool good = dds_create_topic_descriptor(DDS_FIND_SCOPE_LOCAL_DOMAIN, participant, info, 0,
                                            descriptor) == DDS_RETCODE_OK;
    *descriptor = good ? *descriptor : NULL; /* DDS leaves there what it has freed */
    ddsi_type_unref(gv, known);
    return good ? MU_OK : MU_MALFORMED;
}

/* @return whether all of the description is there, and is what it says it is */
static bool is_sound(const struct described *d)
{
    ddsi_typeinfo_t *info = described_info(&d->type);
    bool good = info_is_good(info) && map_is_good(d, info);
    if (info) {
        ddsi_typeinfo_fini(info);
        dds_free(info);
    }
    return good;
}

/* DDS ends the process where it meets what it cannot read, even of bytes that it has looked through
 * before: a child looks first. */
static bool child_finds_sound(const struct described *d)
{
    static const struct rlimit none = {0, 0};
    int status = 0;
    pid_t child = fork();
    if (child == 0) {
        (void)close(STDERR_FILENO);
        (void)setrlimit(RLIMIT_CORE, &none);
        (void)alarm(LOOK_S);
        _exit(is_sound(d) ? 0 : 1);
    }
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return child > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

static mu_result descriptor_make(dds_entity_t participant, const struct described *d,
                                 dds_topic_descriptor_t **descriptor)
{
    if (!child_finds_sound(d)) {
        return MU_MALFORMED;
    }
    ddsi_typeinfo_t *info = described_info(&d->type);
    mu_result made = info ? type_learn(participant, d, info, descriptor) : MU_MALFORMED;
    if (info) {
        ddsi_typeinfo_fini(info);
        dds_free(info);
    }
    return made;
}

static mu_result described_topic(dds_entity_t participant, const struct described *d,
                                 const char *name, const char *type, dds_entity_t *topic)
{
    dds_topic_descriptor_t *descriptor = NULL;
    mu_result made = descriptor_make(participant, d, &descriptor);
    if (made == MU_OK && strcmp(descriptor->m_typename, type) != 0) {
        made = MU_MALFORMED;
    }
    if (made == MU_OK) {
        dds_entity_t created = type_topic(participant, descriptor, name);
        made = created > 0 ? MU_OK : MU_FAULT_DDS;
        *topic = created > 0 ? created : *topic;
    }
    if (descriptor) {
        dds_delete_topic_descriptor(descriptor);
    }
    return made;
}

mu_result type_bytes_topic(dds_entity_t participant, const void *bytes, size_t size,
                           const char *name, const char *type, dds_entity_t *topic)
{
    struct described d;
    unsigned char *copy = dds_alloc(size + 1); /* looking through them may change them */
    memcpy(copy, bytes, size);
    mu_result made = MU_MALFORMED;
    if (described_read(&d, copy, size)) {
        d.map.data = dds_alloc(d.map.sz);
        memcpy(d.map.data, copy + LENGTH_BYTES + d.info.sz, d.map.sz);
        if (is_whole(&d.map, &DDS_XTypes_TypeMapping_desc)) {
            made = described_topic(participant, &d, name, type, topic);
        }
        dds_free(d.map.data);
    }
    dds_free(copy);
    return made;
}
