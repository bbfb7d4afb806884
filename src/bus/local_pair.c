/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/local_pair.h"

#include "bus/local_frame.h"
#include "bus/local_token.h"
#include "bus/topics.h"

#include <errno.h>

void local_pair_close(struct local_pair *p, enum pair_state state)
{
    local_unwatch(p->writer->bus, &p->source);
    dds_free(p->waiting);
    p->waiting = NULL;
    p->size = p->from = p->to = p->begun = 0;
    p->state = state;
}

/* @return whether a reader of another process has a socket */
static bool token_find(const struct bus *bus, const dds_builtintopic_endpoint_t *reader,
                       struct local_token *token)
{
    dds_guid_t own;
    return dds_get_guid(bus->participant, &own) == DDS_RETCODE_OK &&
           memcmp(&own, &reader->participant_key, sizeof own) != 0 &&
           local_token_find(reader, token);
}

void local_pair_ask(struct local_pair *p, const dds_builtintopic_endpoint_t *reader)
{
    struct local_writer *o = p->writer;
    struct local_token token;
    struct local_hello hello = {.mark = LOCAL_HELLO_MARK};
    dds_entity_t who = p->match == PAIR_SERVED ? o->writer : o->bus->participant;
    bool has_socket = token_find(o->bus, reader, &token);
    p->source.fd = has_socket ? local_connect(&token, LOCAL_WAITING_MAX) : -1;
    if (p->source.fd >= 0 && local_is_ours(p->source.fd) &&
        dds_get_guid(who, &hello.writer) == DDS_RETCODE_OK &&
        send(p->source.fd, &hello, LOCAL_HELLO_FIRST, MSG_NOSIGNAL) == LOCAL_HELLO_FIRST) {
        p->state = PAIR_ASKED;
        local_watch(o->bus, &p->source, EPOLLIN);
    } else {
        o->bus->local_refused += p->source.fd >= 0;
        local_pair_close(p, PAIR_ON_DDS);
    }
    p->last = o->last && local_endpoint_names(reader, o->last);
    p->named = o->partition && local_endpoint_names(reader, o->partition);
    p->process = reader->participant_key;
}

void local_pair_leave(struct local_pair *p)
{
    local_pair_close(p, p->match == PAIR_SERVED ? PAIR_ON_DDS : PAIR_LEAVES);
    p->asked_ns = 0;
    p->writer->seen--; /* it looks again, and goes onto DDS */
    p->writer->stale = true;
}

static void answer_take(struct local_pair *p)
{
    char answer;
    dds_time_t since_ns = p->writer->stamp;
    if (recv(p->source.fd, &answer, 1, MSG_DONTWAIT) == 1 &&
        send(p->source.fd, &since_ns, sizeof since_ns, MSG_NOSIGNAL) == (ssize_t)sizeof since_ns) {
        p->state = PAIR_OPEN;
        local_change(p->writer->bus, &p->source, 0); /* its end is told all the same */
    } else {
        p->writer->bus->local_refused++;
        local_pair_leave(p);
    }
}

/* @return how many bytes the kernel took, all of them if the reader is gone; what is left waits */
static size_t bytes_send(struct local_pair *p, const char *data, size_t size)
{
    ssize_t sent = send(p->source.fd, data, size, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && errno != EAGAIN && errno != EINTR) {
        local_pair_close(p, PAIR_ENDED);
        return size;
    }
    return sent > 0 ? (size_t)sent : 0;
}

void local_pair_send(struct local_pair *p)
{
    size_t sent = bytes_send(p, p->waiting + p->from, p->to - p->from);
    if (p->state != PAIR_OPEN) {
        return;
    }
    p->from += sent;
    if (p->from == p->to) {
        dds_free(p->waiting);
        p->waiting = NULL;
        p->size = p->from = p->to = p->begun = 0;
        local_change(p->writer->bus, &p->source, 0);
    }
}

/* Makes the free room one piece. */
static void waiting_close_up(struct local_pair *p)
{
    memmove(p->waiting, p->waiting + p->from, p->to - p->from);
    p->to -= p->from;
    p->begun -= p->begun < p->from ? p->begun : p->from;
    p->from = 0;
}

static void waiting_add(struct local_pair *p, const char *data, size_t size)
{
    if (p->from == p->to) {
        local_change(p->writer->bus, &p->source, EPOLLOUT);
    }
    if (p->from > 0 && p->to + size > p->size) {
        waiting_close_up(p);
    }
    if (p->to + size > p->size) {
        p->size = 2 * (p->to + size);
        p->waiting = dds_realloc(p->waiting, p->size);
    }
    memcpy(p->waiting + p->to, data, size);
    p->to += size;
}

/* Where the last sample alone counts, those that wait are let go, but for one that has begun. */
static void waiting_trim(struct local_pair *p)
{
    p->begun = p->begun < p->from ? p->to : p->begun;
    p->to = p->begun;
}

void local_pair_write(struct local_pair *p, const char *frame, size_t size)
{
    if (p->from < p->to && !topic_table[p->writer->topic].keeps_all) {
        waiting_trim(p);
    }
    size_t sent = p->from == p->to ? bytes_send(p, frame, size) : 0;
    if (sent < size) {
        waiting_add(p, frame + sent, size - sent);
        p->begun = sent > 0 ? p->to : p->begun;
    }
}

void local_pair_ready(struct local_source *source, uint32_t events)
{
    struct local_pair *p = (struct local_pair *)source;
    if (p->state == PAIR_ASKED) {
        answer_take(p);
    } else if (events & (EPOLLHUP | EPOLLERR)) {
        local_pair_close(p, PAIR_ENDED);
    } else {
        local_pair_send(p);
    }
}
