/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/raw/raw.h"

#include <ctype.h>
#include <string.h>

/* DDS's own headers want a word that C11 does not have. */
#define asm __asm__
#include <dds/ddsi/ddsi_xqos.h>

#include <dds/ddsi/ddsi_typelib.h>
#include <dds/ddsi/ddsi_typewrap.h>
#include <dds/ddsi/ddsi_xt_impl.h>

typedef struct DDS_XTypes_TypeIdentifier type_id;

enum { NESTED_MAX = 64, ALIASES_MAX = 8 };

struct schema {
    const struct ddsi_typemap *types;
    struct mu_text *text;
    const DDS_XTypes_CompleteStructType *nested[NESTED_MAX]; /* in the order of their sections */
    size_t count;
    bool refused; /* something cannot be said */
};

/* What plain numbers are called.  An octet is a number there, and a character is one byte. */
static const char *const primitives[] = {
    [DDS_XTypes_TK_BOOLEAN] = "bool",    [DDS_XTypes_TK_BYTE] = "uint8",
    [DDS_XTypes_TK_INT16] = "int16",     [DDS_XTypes_TK_INT32] = "int32",
    [DDS_XTypes_TK_INT64] = "int64",     [DDS_XTypes_TK_UINT16] = "uint16",
    [DDS_XTypes_TK_UINT32] = "uint32",   [DDS_XTypes_TK_UINT64] = "uint64",
    [DDS_XTypes_TK_FLOAT32] = "float32", [DDS_XTypes_TK_FLOAT64] = "float64",
    [DDS_XTypes_TK_CHAR8] = "uint8",
};

/* "a::b::T" is T of the package a; what ROS 2 itself puts into names on DDS is taken out again.
 * between: "/msg/" in the name of a definition, "/" in its text. */
static void name_write(struct mu_text *to, const char *type, const char *between)
{
    const char *first = strstr(type, "::");
    const char *last = type;
    for (const char *at = first; at; at = strstr(last, "::")) {
        last = at + 2;
    }
    size_t len = strlen(last);
    bool is_ros = strstr(type, "::dds_::") && len > 1 && last[len - 1] == '_';
    mu_text_add_bytes(to, first ? type : "dds", first ? (size_t)(first - type) : 3);
    mu_text_add(to, between);
    mu_text_add_bytes(to, last, is_ros ? len - 1 : len);
}

static bool is_hash(const type_id *id)
{
    return id->_d == DDS_XTypes_EK_COMPLETE;
}

/* What a type is; an alias is what it stands for.  @return NULL: it is plain, or not known */
static const DDS_XTypes_CompleteTypeObject *object_find(const struct schema *s, const type_id **id)
{
    for (int i = 0; i < ALIASES_MAX && is_hash(*id); i++) {
        const struct DDS_XTypes_TypeObject *found = ddsi_typemap_typeobj(s->types, *id);
        if (!found || found->_d != DDS_XTypes_EK_COMPLETE) {
            return NULL;
        }
        const DDS_XTypes_CompleteTypeObject *object = &found->_u.complete;
        if (object->_d != DDS_XTypes_TK_ALIAS) {
            return object;
        }
        *id = &object->_u.alias_type.body.common.related_type;
    }
    return NULL;
}

/* Gives a nested type a section of its own, once. */
static void nested_add(struct schema *s, const DDS_XTypes_CompleteStructType *type)
{
    for (size_t i = 0; i < s->count; i++) {
        if (s->nested[i] == type) {
            return;
        }
    }
    s->refused = s->refused || s->count == NESTED_MAX;
    if (s->count < NESTED_MAX) {
        s->nested[s->count++] = type;
    }
}

/* The representation on the wire of an enumeration. */
static const char *enum_type(const DDS_XTypes_CompleteEnumeratedType *e)
{
    unsigned bits = e->header.common.bit_bound;
    return bits <= 8 ? "uint8" : bits <= 16 ? "uint16" : "uint32";
}

/* Another end than @final has lengths within the bytes that such a definition does not know. */
static bool is_plain(const DDS_XTypes_CompleteStructType *type)
{
    return (type->struct_flags & DDS_XTypes_IS_FINAL) && type->header.base_type._d == 0;
}

/* Writes the type of one element.  bound: of a string, behind its name */
static void element_write(struct schema *s, const type_id *id)
{
    const DDS_XTypes_CompleteTypeObject *object = object_find(s, &id);
    if (object && object->_d == DDS_XTypes_TK_STRUCTURE) {
        nested_add(s, &object->_u.struct_type);
        name_write(s->text, object->_u.struct_type.header.detail.type_name, "/");
    } else if (object && object->_d == DDS_XTypes_TK_ENUM) {
        mu_text_add(s->text, enum_type(&object->_u.enumerated_type));
    } else if (id->_d == DDS_XTypes_TI_STRING8_SMALL || id->_d == DDS_XTypes_TI_STRING8_LARGE) {
        uint32_t bound = id->_d == DDS_XTypes_TI_STRING8_SMALL ? id->_u.string_sdefn.bound
                                                               : id->_u.string_ldefn.bound;
        mu_text_add(s->text, "string");
        if (bound > 0) {
            mu_text_format(s->text, "<=%u", (unsigned)bound);
        }
    } else if (id->_d < sizeof primitives / sizeof primitives[0] && primitives[id->_d]) {
        mu_text_add(s->text, primitives[id->_d]);
    } else {
        s->refused = true;
    }
}

static void sequence_write(struct schema *s, const type_id *element, uint32_t bound)
{
    element_write(s, element);
    if (bound > 0) {
        mu_text_format(s->text, "[<=%u]", (unsigned)bound);
    } else {
        mu_text_add(s->text, "[]");
    }
}

static void array_write(struct schema *s, const type_id *element, uint32_t dimensions,
                        uint32_t bound)
{
    s->refused = s->refused || dimensions != 1;
    element_write(s, element);
    mu_text_format(s->text, "[%u]", (unsigned)bound);
}

/* A list that is not plain has a type object of its own. */
static bool list_write(struct schema *s, const DDS_XTypes_CompleteTypeObject *object)
{
    if (object->_d == DDS_XTypes_TK_SEQUENCE) {
        const DDS_XTypes_CompleteSequenceType *q = &object->_u.sequence_type;
        sequence_write(s, &q->element.common.type, q->header.common.bound);
        return true;
    }
    if (object->_d == DDS_XTypes_TK_ARRAY) {
        const DDS_XTypes_CompleteArrayType *a = &object->_u.array_type;
        uint32_t dimensions = a->header.common.bound_seq._length;
        array_write(s, &a->element.common.type, dimensions,
                    dimensions ? a->header.common.bound_seq._buffer[0] : 0);
        return true;
    }
    return false;
}

static void type_write(struct schema *s, const type_id *id)
{
    const DDS_XTypes_CompleteTypeObject *object = object_find(s, &id);
    if (object && list_write(s, object)) {
        return;
    }
    switch (id->_d) {
    case DDS_XTypes_TI_PLAIN_SEQUENCE_SMALL:
        sequence_write(s, id->_u.seq_sdefn.element_identifier, id->_u.seq_sdefn.bound);
        break;
    case DDS_XTypes_TI_PLAIN_SEQUENCE_LARGE:
        sequence_write(s, id->_u.seq_ldefn.element_identifier, id->_u.seq_ldefn.bound);
        break;
    case DDS_XTypes_TI_PLAIN_ARRAY_SMALL:
        array_write(s, id->_u.array_sdefn.element_identifier,
                    id->_u.array_sdefn.array_bound_seq._length,
                    id->_u.array_sdefn.array_bound_seq._buffer[0]);
        break;
    case DDS_XTypes_TI_PLAIN_ARRAY_LARGE:
        array_write(s, id->_u.array_ldefn.element_identifier,
                    id->_u.array_ldefn.array_bound_seq._length,
                    id->_u.array_ldefn.array_bound_seq._buffer[0]);
        break;
    default: element_write(s, id); break;
    }
}

/* Constants are words of capitals there. */
static bool is_constant(const char *name)
{
    bool good = isupper((unsigned char)name[0]) != 0;
    for (const char *c = name; *c && good; c++) {
        good = isupper((unsigned char)*c) || isdigit((unsigned char)*c) ||
               (*c == '_' && c[1] != '_' && c[1]);
    }
    return good;
}

/* Fields are words of small letters there. */
static bool is_field(const char *name)
{
    bool good = islower((unsigned char)name[0]) != 0;
    for (const char *c = name; *c && good; c++) {
        good = islower((unsigned char)*c) || isdigit((unsigned char)*c) ||
               (*c == '_' && c[1] != '_' && c[1]);
    }
    return good;
}

static const DDS_XTypes_CompleteEnumeratedType *enum_of(const struct schema *s, const type_id *id)
{
    const DDS_XTypes_CompleteTypeObject *object = object_find(s, &id);
    return object && object->_d == DDS_XTypes_TK_ENUM ? &object->_u.enumerated_type : NULL;
}

/* @return whether an earlier member of the struct is of the same enumeration */
static bool enum_is_there(const struct schema *s, const DDS_XTypes_CompleteStructType *type,
                          uint32_t member)
{
    const DDS_XTypes_CompleteStructMemberSeq *members = &type->member_seq;
    const DDS_XTypes_CompleteEnumeratedType *e =
        enum_of(s, &members->_buffer[member].common.member_type_id);
    for (uint32_t i = 0; i < member; i++) {
        if (enum_of(s, &members->_buffer[i].common.member_type_id) == e) {
            return true;
        }
    }
    return false;
}

static void constants_write(struct schema *s, const DDS_XTypes_CompleteStructType *type,
                            uint32_t member)
{
    const DDS_XTypes_CompleteEnumeratedType *e =
        enum_of(s, &type->member_seq._buffer[member].common.member_type_id);
    if (!e || enum_is_there(s, type, member)) {
        return;
    }
    for (uint32_t i = 0; i < e->literal_seq._length; i++) {
        const DDS_XTypes_CompleteEnumeratedLiteral *l = &e->literal_seq._buffer[i];
        mu_text_format(s->text, "%s%s %s=%d\n", is_constant(l->detail.name) ? "" : "# ",
                       enum_type(e), l->detail.name, (int)l->common.value);
    }
}

static void struct_write(struct schema *s, const DDS_XTypes_CompleteStructType *type)
{
    s->refused = s->refused || !is_plain(type) || type->member_seq._length == 0;
    for (uint32_t i = 0; i < type->member_seq._length; i++) {
        const DDS_XTypes_CompleteStructMember *m = &type->member_seq._buffer[i];
        s->refused = s->refused || !is_field(m->detail.name) ||
                     (m->common.member_flags & DDS_XTypes_IS_OPTIONAL);
        constants_write(s, type, i);
        type_write(s, &m->common.member_type_id);
        mu_text_format(s->text, " %s\n", m->detail.name);
    }
}

static mu_result schema_make(struct schema *s, const type_id *top, struct mu_text *name)
{
    const DDS_XTypes_CompleteTypeObject *object = object_find(s, &top);
    if (!object || object->_d != DDS_XTypes_TK_STRUCTURE) {
        return MU_ABSENT;
    }
    name_write(name, object->_u.struct_type.header.detail.type_name, "/msg/");
    nested_add(s, &object->_u.struct_type);
    for (size_t i = 0; i < s->count; i++) {
        if (i > 0) {
            mu_text_add(s->text,
                        "=========================================================================="
                        "======\nMSG: ");
            name_write(s->text, s->nested[i]->header.detail.type_name, "/");
            mu_text_add(s->text, "\n");
        }
        struct_write(s, s->nested[i]);
    }
    if (s->text->cut || name->cut) {
        return MU_FULL;
    }
    return s->refused ? MU_REFUSED : MU_OK;
}

mu_result schema_write(const dds_topic_descriptor_t *d, struct mu_text *name, struct mu_text *text)
{
    if (!(d->m_flagset & DDS_TOPIC_XTYPES_METADATA)) {
        return MU_ABSENT;
    }
    /* Nothing is written through these. */
    struct ddsi_sertype_cdr_data info_bytes = {d->type_information.sz,
                                               (uint8_t *)(uintptr_t)d->type_information.data};
    struct ddsi_sertype_cdr_data map_bytes = {d->type_mapping.sz,
                                              (uint8_t *)(uintptr_t)d->type_mapping.data};
    ddsi_typeinfo_t *info = ddsi_typeinfo_deser(&info_bytes);
    ddsi_typemap_t *types = ddsi_typemap_deser(&map_bytes);
    mu_result made = MU_ABSENT;
    if (info && types) {
        struct schema s = {.types = types, .text = text};
        made = schema_make(&s, &ddsi_typeinfo_complete_typeid(info)->x, name);
    }
    if (types) {
        ddsi_typemap_fini(types);
        dds_free(types);
    }
    if (info) {
        ddsi_typeinfo_fini(info);
        dds_free(info);
    }
    return made;
}
