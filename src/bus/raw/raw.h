/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file raw.h
 * Samples as bytes, and topics that we were not compiled with: for recordings, and what reads them.
 */
#ifndef MUSTER_BUS_RAW_H
#define MUSTER_BUS_RAW_H

#include "bus/bus.h"
#include "core/text.h"
#include "muster/result.h"

#include <dds/dds.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* --- raw_encode.c --------------------------------------------------------------------------------
 */

/* A sample as bytes, in memory that is used again for the next one. */
struct bus_bytes {
    const unsigned char *data; /* with the four bytes of the encapsulation before it */
    size_t size;
    unsigned char *room; /* DDS's own */
    uint32_t room_size;
};

/**
 * Turns a sample into the bytes that would go out for it: CDR, little-endian, version 1, with its
 * encapsulation, for programs that keep samples in a file.
 *
 * @param to  zero at first; data is good until the next call with it
 * @return MU_OK; MU_MALFORMED: an enumeration has a value that its type does not know
 */
MU_MUST_USE mu_result bus_encode(enum bus_topic topic, const void *sample, struct bus_bytes *to);

/** Gives the memory of bytes back. */
void bus_bytes_free(struct bus_bytes *bytes);

/**
 * Turns such bytes into a sample again, for readers of a recording; they are checked as samples
 * from the network are.
 *
 * @param bytes   its numbers are put in this machine's order
 * @param sample  out: DDS's memory, for bus_decode_free
 * @return MU_OK; MU_MALFORMED: they are no sample of that topic, or break a rule of the wire
 */
MU_MUST_USE mu_result bus_decode(enum bus_topic topic, void *bytes, size_t size, void **sample);

/** Gives a sample back; NULL: nothing to do. */
void bus_decode_free(enum bus_topic topic, void *sample);

/* --- profile.c ------------------------------------------------------------------------------- */

/*
 * Quality of service as rosbag2 writes it into its files ("offered_qos_profiles"): YAML, with the
 * numbers of the rmw.
 */

/** Writes the profile; what is not set is DDS's default. */
void profile_write(const dds_qos_t *qos, struct mu_text *text);

/* --- offer.c --------------------------------------------------------------------------------- */

/*
 * What a writer offers, as words: for recordings, out of which a writer is made that the readers of
 * the first one take for the same.
 *
 * "reliability=1 durability=0 deadline=100000000 ..."; a policy's kind is its number in DDS, times
 * are nanoseconds.
 */

/** Writes all that readers match by, but for partitions; 384 bytes are enough. */
void offer_write(const dds_qos_t *qos, struct mu_text *words);

/** Sets what the words say, for a writer and for its publisher.  What is no policy, or no value of
 * one, is passed over. */
void offer_read(const char *words, dds_qos_t *qos);

/* --- gone.c ---------------------------------------------------------------------------------- */

/*
 * That an instance was disposed or has no writers any more, as a message of a recording.
 *
 * It is a small message of its own type, on a channel beside that of the topic's samples, so that a
 * program that decodes a topic by its definition finds only samples there.
 */

enum gone_what {
    GONE_NOT,          /* it lives */
    GONE_DISPOSED,     /* a writer took it back */
    GONE_UNREGISTERED, /* no writer has it any more */
};

/* Behind the name of a topic: the name of the channel of what has gone. */
#define GONE_SUFFIX      "/gone"
#define GONE_SCHEMA_NAME "muster/msg/Gone"
#define GONE_SCHEMA      "uint8 DISPOSED=1\nuint8 UNREGISTERED=2\nuint8 what\nuint8[] key\n"

enum { GONE_HEAD_BYTES = 12 };

/**
 * Writes such a message in CDR.
 *
 * @param key  of the instance, as DDS serialises it, with its encapsulation
 * @param to   GONE_HEAD_BYTES more than the key has
 * @return how many bytes it has
 */
size_t gone_write(uint8_t *to, enum gone_what what, const void *key, size_t key_size);

/**
 * Reads such a message.
 *
 * @param key  out: points into the bytes
 * @return GONE_NOT: it is none
 */
enum gone_what gone_read(const void *bytes, size_t size, const void **key, size_t *key_size);

/* --- schema.c -------------------------------------------------------------------------------- */

/*
 * A type as text, for readers of recordings: made from what the type says of itself on DDS.
 *
 * The text is a ROS 2 message definition ("ros2msg"), with all types that it is made of, because
 * most tools know that one.  An enumeration becomes an integer, and its words constants.
 */

/**
 * Writes the definition of a type.
 *
 * @param name  out: "muster/msg/Frame"
 * @param text  out: the definition
 * @return MU_OK; MU_ABSENT: the type does not describe itself; MU_REFUSED: it has something that
 *         such a definition cannot say, such as a union; MU_FULL: no room
 */
mu_result schema_write(const dds_topic_descriptor_t *descriptor, struct mu_text *name,
                       struct mu_text *text);

/* --- type_bytes.c ---------------------------------------------------------------------------- */

/*
 * A type as bytes, for recordings of topics that we were not compiled with, and a topic of such
 * bytes again.
 *
 * The bytes are what DDS programs tell one another of a type (DDS-XTypes 1.3, 7.6.3.2): the length
 * of its TypeInformation in four bytes, little-endian; the TypeInformation; the TypeMapping with
 * the objects of all types in it.  Both are CDR of the second version, little-endian.
 */

/* Room for a type's name among types, with its zero: 14 bytes as hexadecimal digits. */
enum { TYPE_HASH_MAX = 2 * 14 + 1 };

/**
 * Writes a type.
 *
 * @param hash  out: two types of one name have different ones
 * @return how many bytes it has; 0: it does not describe itself, or they are more than size
 */
size_t type_bytes_write(const dds_topic_descriptor_t *d, void *to, size_t size,
                        char hash[TYPE_HASH_MAX]);

/**
 * Makes a topic of a type that DDS has put together from what programs say of it.
 *
 * Cyclone DDS 0.10.2 takes every key of such a type for a short one, and writes those with texts
 * past the end of 16 bytes: here all are taken for long.
 *
 * @return the topic, or below 0
 */
dds_entity_t type_topic(dds_entity_t participant, const dds_topic_descriptor_t *d,
                        const char *name);

/**
 * Makes a topic of such bytes.  Nothing in them is believed: a child of this process reads them
 * first, and each object must have the hash that it is known by.
 *
 * @param type  what the type must be called
 * @return MU_OK; MU_MALFORMED: they are no such type; MU_FAULT_DDS
 */
MU_MUST_USE mu_result type_bytes_topic(dds_entity_t participant, const void *bytes, size_t size,
                                       const char *name, const char *type, dds_entity_t *topic);

/* --- tap.c ----------------------------------------------------------------------------------- */

/*
 * Topics as bytes: for programs that record samples without looking into them, of our topics and of
 * any.
 *
 * A tap is a reader of one topic in every partition.  It asks for what the writers offer, so that a
 * reliable writer is read reliably; it keeps the last TAP_DEPTH samples of an instance until they
 * are taken.
 */

enum { TAP_NAME_MAX = 255, TAP_DEPTH = 8192, TAP_BATCH = 256 };

/* Partitions of one writer, and what one offers, in bytes. */
enum { TAP_PARTITIONS_MAX = 1023, TAP_OFFER_MAX = 511 };

/* The four of two values are independent: a writer may offer any of the first three, of any topic.
 */
struct tap {
    char name[TAP_NAME_MAX + 1]; /* of the topic */
    char type[TAP_NAME_MAX + 1]; /* as on DDS: "muster::Frame" */
    int32_t topic, reader;       /* 0: not open */
    bool reliable, durable;      /* what the reader asks for: no more than each writer offers */
    bool exclusive;              /* instances belong to their strongest writers: these alone */
    bool ours;                   /* the topic is in our table */
    uint64_t retry_ns;           /* not open: when to try again, by the monotonic clock */
};

/* One sample of a tap, or that an instance has gone. */
struct tap_sample {
    enum gone_what gone; /* not GONE_NOT: data is the key of the instance */
    const void *data; /* with the four bytes of its encapsulation; good until the taker returns */
    size_t size;
    uint64_t source_ns; /* when it was written, by its writer's clock, since 1970 */
    uint64_t writer;    /* which one wrote it: for tap_offer */
};

/* What a writer offers to readers. */
struct tap_offer {
    char partitions[TAP_PARTITIONS_MAX + 1]; /* the names, a line each; "": the default one */
    char words[TAP_OFFER_MAX + 1];           /* its quality of service (offer.h); "" of ours */
};

typedef void tap_taker(void *self, struct tap *tap, const struct tap_sample *sample);

/* The source of what there is on the network. */
struct tap_watch {
    struct bus *bus;
    int32_t publications, subscriptions;
    uint64_t looked_ns; /* when all were looked at last, not the new ones alone */
};

/** Opens a tap of one of our topics, before there is a writer.  @return MU_OK or MU_FAULT_DDS */
MU_MUST_USE mu_result tap_open(struct tap *tap, struct bus *bus, enum bus_topic topic);

/** Looks for topics from now on. */
MU_MUST_USE mu_result tap_watch_open(struct tap_watch *watch, struct bus *bus);

/**
 * Opens taps for topics that have writers and no tap yet, and has those that ask for too much ask
 * for less.  Our topics are known by name; the types of others are asked for, which takes up to
 * 200 ms each, and is tried again while it fails.
 *
 * @param taps    in, out: one for each topic that has been seen, open or not
 * @param wanted  whether a topic is wanted; NULL: all are
 * @return how many there are now, at most max
 */
size_t tap_watch_look(struct tap_watch *watch, struct tap *taps, size_t count, size_t max,
                      bool (*wanted)(const char *topic));

/**
 * Hands out the samples that are there, those of one batch in the order in which they were written:
 * DDS itself puts the samples of an instance together.
 *
 * So, too, that an instance was disposed, or has no writers any more: once each time, between the
 * samples before and those after it.  Where several things became of it between two calls, when it
 * was that it had gone is not known, and is taken to be when the sample before it was written.
 *
 * @return how many samples; 0: none is there now
 */
size_t tap_take(struct tap *tap, tap_taker *take, void *self);

/** Finds what a writer of a tap offers.  @return false: it is gone; the offer is empty */
bool tap_offer(const struct tap *tap, uint64_t writer, struct tap_offer *offer);

/** Writes what the type looks like, as bus_schema; MU_ABSENT, MU_REFUSED: it cannot be said. */
mu_result tap_schema(const struct tap *tap, struct mu_text *name, struct mu_text *text);

/**
 * Writes the type of a topic that is not ours as bytes, for feed_open_foreign.
 *
 * @param name  out: "zoo::Animal-HASH", the same for the same type alone
 * @return how many bytes; 0: it does not describe itself, or there is no room
 */
size_t tap_type(const struct tap *tap, void *to, size_t size, struct mu_text *name);

/** Writes the quality of service that the topic's writers offer, as rosbag2 does in its files. */
void tap_profile(const struct tap *tap, const struct tap_offer *offer, struct mu_text *text);

/* --- feed.c ---------------------------------------------------------------------------------- */

/*
 * Bytes to topics: for programs that replay samples that a tap or the simulator has recorded.
 *
 * A feed is a writer of one of our topics, or of any whose type a tap has kept.  It keeps each
 * sample until every reliable reader has it, however fast they come.
 */

struct feed {
    struct bus_writer out;
    const void *type; /* DDS's own, of the topic */
};

/* A topic that we were not compiled with, as a recording has it. */
struct feed_foreign {
    const char *topic, *type; /* their names on DDS */
    const void *type_bytes;   /* as from tap_type */
    size_t type_size;
    const char *words; /* what its writer offered: offer.h */
    const char *const *partitions;
    size_t partition_count;
};

/** Finds one of our topics by its name, and that of its type on DDS; NULL: it is not known.
 * @return false: there is none */
bool feed_topic(const char *name, const char *type, enum bus_topic *topic);

/** Opens a feed into one or two partitions, as bus_writer_open.  @return MU_OK or MU_FAULT_DDS */
MU_MUST_USE mu_result feed_open(struct feed *feed, struct bus *bus, enum bus_topic topic,
                                const char *first, const char *second);

/**
 * Opens a feed of a topic that is not ours, from what was recorded: it offers what the
 * writer did, and is reliable.
 *
 * @return MU_OK; MU_MALFORMED: the bytes are no such type; MU_REFUSED: there can be no such writer
 */
MU_MUST_USE mu_result feed_open_foreign(struct feed *feed, struct bus *bus,
                                        const struct feed_foreign *of);

/**
 * Writes a sample.
 *
 * @param bytes  with the four bytes of the encapsulation; looked through before they are written
 * @return MU_OK; MU_BUSY: readers do not keep up, try again; MU_MALFORMED: these bytes are no such
 *         sample; MU_FAULT_DDS
 */
MU_MUST_USE mu_result feed_write(struct feed *feed, const void *bytes, size_t size);

/**
 * Says that an instance has gone.
 *
 * @param key  of the instance, as a tap had it
 * @return as feed_write
 */
MU_MUST_USE mu_result feed_gone(struct feed *feed, enum gone_what what, const void *key,
                                size_t size);

/* --- raw_schema.c --------------------------------------------------------------------------------
 */

/**
 * Writes the definition of a topic's type as a ROS 2 message, for recordings.  Takes memory from
 * DDS, and gives it back.
 *
 * @param name  out: "muster/msg/Frame"
 * @param text  out: the definition, with those of the types in it; 16 kB are enough for each
 * @return MU_OK; MU_FULL: no room
 */
mu_result bus_schema(enum bus_topic topic, struct mu_text *name, struct mu_text *text);

/**
 * Says whether a recording describes a topic's type as one of today would.
 *
 * @param schema  what bus_schema wrote then; size 0: it does not say, which is no difference
 */
bool bus_schema_is(enum bus_topic topic, const void *schema, size_t size);

/** Writes the quality of service of a topic as rosbag2 does in its files; 1 kB is enough. */
void bus_profile(enum bus_topic topic, struct mu_text *text);

#endif
