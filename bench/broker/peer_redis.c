/* SPDX-License-Identifier: Apache-2.0 */
/* A box is a list: mail is stored with RPUSH.  Only stored mail is measured against Redis. */
#include "peer.h"

#include "load.h"

#include <hiredis/hiredis.h>
#include <stdlib.h>

static struct {
    redisContext *context;
    uint64_t sent, answered;
} peer;

void peer_open(const struct peer_options *options)
{
    peer.context = redisConnect("127.0.0.1", (int)strtol(options->where, NULL, 10));
    if (!peer.context || peer.context->err) {
        load_die("no Redis at port %s", options->where);
    }
}

bool peer_send(const char *to, const char *text, enum mu_level level)
{
    (void)level; /* the server's setting */
    if (redisAppendCommand(peer.context, "RPUSH box:%s %b", to, text, (size_t)LOAD_BYTES) !=
        REDIS_OK) {
        load_die("%s", peer.context->errstr);
    }
    peer.sent++;
    return true;
}

void peer_answer(const char *to, const char *text)
{
    (void)text;
    load_die("nothing comes that %s could want an answer to", to);
}

static void reply_take(void *reply)
{
    const redisReply *r = reply;
    if (r->type != REDIS_REPLY_INTEGER) {
        load_die("not stored: %s", r->str ? r->str : "?");
    }
    freeReplyObject(reply);
    peer.answered++;
}

/* Blocks until one answer is there, if any is to come. */
void peer_spin(int64_t timeout_ns)
{
    (void)timeout_ns;
    void *reply = NULL;
    if (peer.answered == peer.sent) {
        return;
    }
    if (redisGetReply(peer.context, &reply) != REDIS_OK) {
        load_die("%s", peer.context->errstr);
    }
    reply_take(reply);
    while (redisGetReplyFromReader(peer.context, &reply) == REDIS_OK && reply) {
        reply_take(reply);
    }
}

void peer_serve(void)
{
    load_spin_on();
}

uint64_t peer_answered(void)
{
    return peer.answered;
}

void peer_close(void)
{
    redisFree(peer.context);
}
