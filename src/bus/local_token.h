/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file local_token.h
 * The socket of a reader, and its name in the reader's discovery data (local.h).
 *
 * The socket is no file and ends with its process (unix(7), abstract).
 */
#ifndef MUSTER_BUS_LOCAL_TOKEN_H
#define MUSTER_BUS_LOCAL_TOKEN_H

#include <dds/dds.h>
#include <stdbool.h>

/* As it stands in the reader's USER_DATA. */
struct local_token {
    char mark[8];
    char name[32];    /* random digits of base 16 */
    dds_guid_t owner; /* the reader's participant: tools copy a reader's quality of service whole */
};

/** Makes a socket of a new name that listens, for a reader of the participant.  @return it; -1: the
 * system has none left */
int local_listen(struct local_token *token, dds_entity_t participant);

/** Connects to a socket.  @param room  bytes that the kernel is to keep  @return -1: it is not of
 * this host, or none is left */
int local_connect(const struct local_token *token, int room);

/** @return whether a reader's quality of service has a token of its own */
bool local_token_find(const dds_builtintopic_endpoint_t *reader, struct local_token *token);

/** @return whether one of the partitions that an endpoint names is this one */
bool local_endpoint_names(const dds_builtintopic_endpoint_t *endpoint, const char *partition);

/** @return whether the other end is of our user */
bool local_is_ours(int fd);

#endif
