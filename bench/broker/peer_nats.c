/* SPDX-License-Identifier: Apache-2.0 */
/* Subjects: mail.NAME for one, all for all.  The library's event loop interface with a poll() of
 * ours: one thread reads and writes, as libmosquitto's loop does. */
#include "peer.h"

#include "load.h"

#include <nats/nats.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SUBSCRIPTIONS_MAX = 2, BUFFERED_MAX = 65536 };

static struct {
    natsConnection *connection;
    natsSubscription *subscriptions[SUBSCRIPTIONS_MAX];
    uint32_t subscriptions_count;
    void (*on_mail)(const char *text);
    int fd;
    bool writes; /* something waits to be written */
} peer;

static void or_die(natsStatus status, const char *what)
{
    if (status != NATS_OK) {
        load_die("%s: %s", what, natsStatus_GetText(status));
    }
}

static natsStatus on_attach(void **self, void *loop, natsConnection *connection, natsSock socket)
{
    (void)loop;
    *self = connection;
    peer.fd = socket;
    return NATS_OK;
}

static natsStatus on_read_wanted(void *self, bool wanted)
{
    (void)self;
    (void)wanted;
    return NATS_OK;
}

static natsStatus on_write_wanted(void *self, bool wanted)
{
    (void)self;
    peer.writes = wanted;
    return NATS_OK;
}

static natsStatus on_detach(void *self)
{
    (void)self;
    return NATS_OK;
}

static void subject_take(const char *subject)
{
    natsSubscription **s = &peer.subscriptions[peer.subscriptions_count++];
    or_die(natsConnection_SubscribeSync(s, peer.connection, subject), "subscribe");
    or_die(natsSubscription_SetPendingLimits(*s, -1, -1), "limits");
}

static void connection_open(const char *port)
{
    char url[64];
    natsOptions *options = NULL;
    snprintf(url, sizeof url, "nats://127.0.0.1:%s", port);
    or_die(natsOptions_Create(&options), "options");
    or_die(natsOptions_SetURL(options, url), "URL");
    or_die(natsOptions_SetSendAsap(options, true), "options");
    or_die(natsOptions_SetEventLoop(options, &peer, on_attach, on_read_wanted, on_write_wanted,
                                    on_detach),
           "event loop");
    or_die(natsConnection_Connect(&peer.connection, options), "connect");
    natsOptions_Destroy(options);
}

/* The server handles a connection's messages in order: a mail to itself comes back behind the
 * subscriptions. */
static void subscriptions_await(void)
{
    natsSubscription *probe = NULL;
    natsMsg *back = NULL;
    char subject[64];
    snprintf(subject, sizeof subject, "probe.%s", load_me());
    or_die(natsConnection_SubscribeSync(&probe, peer.connection, subject), "subscribe");
    or_die(natsConnection_Publish(peer.connection, subject, "", 0), "publish");
    while (natsSubscription_NextMsg(&back, probe, 0) != NATS_OK) {
        peer_spin(10000000);
    }
    natsMsg_Destroy(back);
    natsSubscription_Destroy(probe);
}

void peer_open(const struct peer_options *options)
{
    char subject[64];
    peer.on_mail = options->on_mail;
    connection_open(options->where);
    snprintf(subject, sizeof subject, "mail.%s", options->name);
    subject_take(subject);
    if (strncmp(options->name, "sender", 6) != 0) {
        subject_take("all");
    }
    subscriptions_await();
}

bool peer_send(const char *to, const char *text, enum mu_level level)
{
    (void)level; /* the server without JetStream keeps nothing */
    if (natsConnection_Buffered(peer.connection) > BUFFERED_MAX) {
        return false;
    }
    char subject[64];
    bool all = strcmp(to, "all") == 0;
    snprintf(subject, sizeof subject, all ? "%s" : "mail.%s", to);
    or_die(natsConnection_Publish(peer.connection, subject, text, LOAD_BYTES), "publish");
    return true;
}

void peer_answer(const char *to, const char *text)
{
    load_send(to, text, 0);
}

static void mail_take(natsMsg *mail)
{
    char text[LOAD_BYTES + 1] = "";
    if (natsMsg_GetDataLength(mail) != LOAD_BYTES) {
        load_die("a message of %d bytes", natsMsg_GetDataLength(mail));
    }
    memcpy(text, natsMsg_GetData(mail), LOAD_BYTES);
    natsMsg_Destroy(mail);
    peer.on_mail(text);
}

static void pending_write(void)
{
    if (peer.writes) {
        natsConnection_ProcessWriteEvent(peer.connection);
    }
}

void peer_spin(int64_t timeout_ns)
{
    pending_write();
    struct pollfd fd = {.fd = peer.fd, .events = (short)(POLLIN | (peer.writes ? POLLOUT : 0))};
    struct timespec timeout = {timeout_ns / 1000000000, timeout_ns % 1000000000};
    if (ppoll(&fd, 1, &timeout, NULL) > 0 && (fd.revents & ~POLLOUT)) {
        natsConnection_ProcessReadEvent(peer.connection);
    }
    for (uint32_t i = 0; i < peer.subscriptions_count; i++) {
        natsMsg *mail = NULL;
        while (natsSubscription_NextMsg(&mail, peer.subscriptions[i], 0) == NATS_OK) {
            mail_take(mail);
        }
    }
    pending_write();
    if (natsConnection_IsClosed(peer.connection)) {
        load_die("the connection has ended");
    }
}

void peer_serve(void)
{
    load_spin_on();
}

uint64_t peer_answered(void)
{
    return 0;
}

void peer_close(void)
{
    natsConnection_Close(peer.connection);
    natsConnection_Destroy(peer.connection);
}
