/* SPDX-License-Identifier: Apache-2.0 */
/* Topics: mail/NAME for one, all for all.  Nothing is published from a callback: the library would
 * only queue it there, and need another turn of its loop to write it.  The library's own loop waits
 * whole milliseconds; a poll() of ours waits as long as it is asked to. */
#include "peer.h"

#include "core/clock.h"
#include "load.h"

#include <mosquitto.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t PATIENCE_NS = 20000000000;

enum { ANSWERS_MAX = 4096 };

struct answer {
    char to[32], text[LOAD_BYTES + 1];
};

static struct {
    struct answer answers[ANSWERS_MAX]; /* wait until on_mail has returned */
    uint32_t answers_count;
    struct mosquitto *session;
    void (*on_mail)(const char *text);
    int subscribed;
    uint64_t answered;
} peer;

static void or_die(int code, const char *what)
{
    if (code != MOSQ_ERR_SUCCESS) {
        load_die("%s: %s", what, mosquitto_strerror(code));
    }
}

static void on_connect(struct mosquitto *session, void *self, int code)
{
    (void)session;
    (void)self;
    or_die(code, "connect");
}

static void on_subscribe(struct mosquitto *session, void *self, int id, int count,
                         const int *granted)
{
    (void)session;
    (void)self;
    (void)id;
    (void)count;
    (void)granted;
    peer.subscribed++;
}

static void on_publish(struct mosquitto *session, void *self, int id)
{
    (void)session;
    (void)self;
    (void)id;
    peer.answered++;
}

static void on_message(struct mosquitto *session, void *self, const struct mosquitto_message *m)
{
    (void)session;
    (void)self;
    char text[LOAD_BYTES + 1] = "";
    if (m->payloadlen != LOAD_BYTES) {
        load_die("a message of %d bytes", m->payloadlen);
    }
    memcpy(text, m->payload, LOAD_BYTES);
    peer.on_mail(text);
}

static void session_open(const struct peer_options *options)
{
    mosquitto_lib_init();
    peer.session = mosquitto_new(options->name, !options->boxed, NULL);
    if (!peer.session) {
        load_die("no session");
    }
    mosquitto_int_option(peer.session, MOSQ_OPT_TCP_NODELAY, 1);
    mosquitto_max_inflight_messages_set(peer.session, 0);
    mosquitto_connect_callback_set(peer.session, on_connect);
    mosquitto_subscribe_callback_set(peer.session, on_subscribe);
    mosquitto_publish_callback_set(peer.session, on_publish);
    mosquitto_message_callback_set(peer.session, on_message);
    int port = (int)strtol(options->where, NULL, 10);
    or_die(mosquitto_connect(peer.session, "127.0.0.1", port, 60), "connect");
}

void peer_open(const struct peer_options *options)
{
    peer.on_mail = options->on_mail;
    session_open(options);
    char topic[64];
    snprintf(topic, sizeof topic, "mail/%s", options->name);
    int qos = options->boxed ? 1 : 0;
    int wanted = 1;
    or_die(mosquitto_subscribe(peer.session, NULL, topic, qos), "subscribe");
    if (strncmp(options->name, "sender", 6) != 0) {
        wanted++;
        or_die(mosquitto_subscribe(peer.session, NULL, "all", qos), "subscribe");
    }
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (peer.subscribed < wanted) {
        peer_spin(10000000);
        if (mu_clock_ns() > until_ns) {
            load_die("no broker at port %s", options->where);
        }
    }
}

bool peer_send(const char *to, const char *text, enum mu_level level)
{
    if (mosquitto_want_write(peer.session)) {
        return false;
    }
    char topic[64];
    bool all = strcmp(to, "all") == 0;
    snprintf(topic, sizeof topic, all ? "%s" : "mail/%s", to);
    int qos = level == MU_LEVEL_RAM ? 0 : 1;
    or_die(mosquitto_publish(peer.session, NULL, topic, LOAD_BYTES, text, qos, false), "publish");
    return true;
}

void peer_answer(const char *to, const char *text)
{
    if (peer.answers_count == ANSWERS_MAX) {
        load_die("no room for an answer to %s", to);
    }
    struct answer *a = &peer.answers[peer.answers_count++];
    snprintf(a->to, sizeof a->to, "%s", to);
    memcpy(a->text, text, sizeof a->text);
}

static void answers_send(void)
{
    uint32_t sent = 0;
    while (sent < peer.answers_count &&
           peer_send(peer.answers[sent].to, peer.answers[sent].text, MU_LEVEL_RAM)) {
        sent++;
    }
    peer.answers_count -= sent;
    memmove(peer.answers, peer.answers + sent, peer.answers_count * sizeof peer.answers[0]);
}

void peer_spin(int64_t timeout_ns)
{
    bool writes = mosquitto_want_write(peer.session);
    struct pollfd fd = {.fd = mosquitto_socket(peer.session),
                        .events = (short)(POLLIN | (writes ? POLLOUT : 0))};
    struct timespec timeout = {timeout_ns / 1000000000, timeout_ns % 1000000000};
    if (ppoll(&fd, 1, &timeout, NULL) > 0) {
        if (fd.revents & POLLOUT) {
            or_die(mosquitto_loop_write(peer.session, 1), "write");
        }
        if (fd.revents & ~POLLOUT) {
            or_die(mosquitto_loop_read(peer.session, 1), "read");
        }
    }
    or_die(mosquitto_loop_misc(peer.session), "loop");
    answers_send();
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
    mosquitto_disconnect(peer.session);
    (void)mosquitto_loop(peer.session, 0, 1);
    mosquitto_destroy(peer.session);
}
