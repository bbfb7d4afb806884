/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file mcap_channel.h
 * What a recording is made of: channels, and messages on them.
 */
#ifndef MUSTER_MCAP_MCAP_CHANNEL_H
#define MUSTER_MCAP_MCAP_CHANNEL_H

#include <stddef.h>
#include <stdint.h>

/* A key and its value. */
struct mcap_pair {
    const char *key, *value;
};

/* A topic, and how its messages are to be understood. */
struct mcap_channel {
    const char *topic;
    const char *encoding;        /* of messages: "cdr" */
    const char *schema_name;     /* "muster/msg/Frame"; "": there is no schema */
    const char *schema_encoding; /* "ros2msg" */
    const void *schema;          /* bytes, no zero at the end */
    size_t schema_size;
    const struct mcap_pair *pairs;
    size_t pairs_count;
    uint64_t messages; /* of a channel that is read: how many; 0: the file does not say */
};

struct mcap_message {
    uint32_t channel;    /* index of the channel, in the order in which they were added */
    uint32_t sequence;   /* of the one who recorded; as good as any number */
    uint64_t log_ns;     /* the time that recordings are sorted by; of a run: simulated */
    uint64_t publish_ns; /* when it was written, nanoseconds since 1970 */
    const void *data;
    size_t size;
};

#endif
