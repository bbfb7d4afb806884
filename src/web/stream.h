/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file stream.h
 * What is under way to one viewer: an event that it is reading, its own that wait, and how much of
 * the board it has seen.
 *
 * A viewer that does not read holds one event and a queue of fixed size.  The board goes on without
 * it: frames that it has missed are counted, and it is told the count.  Pure.
 */
#ifndef MUSTER_WEB_STREAM_H
#define MUSTER_WEB_STREAM_H

#include "muster/result.h"
#include "web/board.h"

enum { STREAM_QUEUE_BYTES = 512 * 1024 };

struct stream {
    char *event; /* being read; BOARD_EVENT_MAX bytes */
    size_t event_len, event_at;
    char *queue; /* whole events, one behind the other; STREAM_QUEUE_BYTES */
    size_t queue_len;
    uint64_t seen[BOARD_ITEMS]; /* versions that it has */
    unsigned turn;              /* item of the board that is looked at first */
    uint64_t missed;            /* frames that were replaced before it read them */
    uint64_t lost;              /* events of its own that found the queue full */
    uint64_t told;              /* missed and lost, as it was told */
};

/** Takes the memory, at start-up. */
void stream_init(struct stream *o);

/** Makes it as good as new, for another viewer. */
void stream_clear(struct stream *o);

/** Adds an event of the viewer's own.  @return MU_OK; MU_FULL: it is left out, and counted */
mu_result stream_put(struct stream *o, const struct mu_text *event);

/** @return whether there is something that it has not got */
bool stream_has(const struct stream *o, const struct board *b);

/** Hands out what comes next.  @return bytes written to buffer; 0: there is nothing now */
size_t stream_read(struct stream *o, const struct board *b, char *buffer, size_t size);

#endif
