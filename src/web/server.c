/* SPDX-License-Identifier: Apache-2.0 */
#include "web/web.h"

#include "core/log.h"
#include "muster/memory.h"
#include "muster/version.h"

#include <arpa/inet.h>
#include <errno.h>
#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    SERVER_CONNECTIONS_MAX = 96,
    SERVER_HEADER_BYTES = 32 * 1024, /* of one connection, for its headers and what it is sent */
    SERVER_BLOCK_BYTES = 16 * 1024,
    SERVER_PATIENCE_S = 5,        /* for a request */
    SERVER_READ_PATIENCE_S = 300, /* for a viewer that does not read */
    SERVER_ASSETS_MAX = 64
};

/* A viewer that is gone is found when something is written to it. */
static const uint64_t BEAT_NS = 5000000000;

struct request {
    bool used;
    enum guard_verdict verdict;
    size_t len;
    char body[GUARD_BODY_MAX + 1];
};

struct server {
    struct server_parts parts;
    struct MHD_Daemon *daemon;
    struct MHD_Response *assets[SERVER_ASSETS_MAX];
    struct MHD_Response *scene; /* the board's, made on request; NULL: none */
    uint64_t scene_version;     /* that it has */
    struct request requests[SERVER_CONNECTIONS_MAX];
    struct lobby lobby;
    uint64_t now_ns;
};

/* --- answers ---------------------------------------------------------------------------------- */

/* What every answer says: nothing from elsewhere, nothing to elsewhere, and no script but ours. */
static void headers_add(struct MHD_Response *r, const char *type)
{
    static const char *const headers[][2] = {
        {"Content-Security-Policy",
         "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; "
         "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; "
         "require-trusted-types-for 'script'; trusted-types 'none'"},
        {"X-Content-Type-Options", "nosniff"},
        {"X-Frame-Options", "DENY"},
        {"Referrer-Policy", "no-referrer"},
        {"Cross-Origin-Resource-Policy", "same-origin"},
        {"Cross-Origin-Opener-Policy", "same-origin"},
        {"Cache-Control", "no-store"},
    };
    MHD_add_response_header(r, "Content-Type", type);
    for (size_t i = 0; i < sizeof headers / sizeof headers[0]; i++) {
        MHD_add_response_header(r, headers[i][0], headers[i][1]);
    }
}

static enum MHD_Result text_answer(struct MHD_Connection *c, unsigned status, const char *type,
                                   const struct mu_text *text)
{
    struct MHD_Response *r =
        MHD_create_response_from_buffer(text->len, text->at, MHD_RESPMEM_MUST_COPY);
    if (!r) {
        return MHD_NO;
    }
    headers_add(r, type);
    if (status == MHD_HTTP_METHOD_NOT_ALLOWED) {
        MHD_add_response_header(r, "Allow", "GET, HEAD, POST");
    }
    enum MHD_Result queued = MHD_queue_response(c, status, r);
    MHD_destroy_response(r);
    return queued;
}

static enum MHD_Result line_answer(struct MHD_Connection *c, unsigned status, const char *line)
{
    char bytes[384];
    struct mu_text text = mu_text_in(bytes, sizeof bytes);
    mu_text_add(&text, line);
    return text_answer(c, status, "text/plain; charset=utf-8", &text);
}

/* One copy is for all that fetch it: it may be large, and they may read slowly. */
static enum MHD_Result scene_answer(struct server *s, struct MHD_Connection *c)
{
    const struct board *b = s->parts.board;
    uint64_t version = b->items[BOARD_SCENE].version;
    if (b->scene.len == 0) {
        return line_answer(c, MHD_HTTP_NOT_FOUND,
                           version > 0 ? "the world is too large for a page\n"
                                       : "there is no world yet\n");
    }
    if (s->scene && s->scene_version != version) {
        MHD_destroy_response(s->scene);
        s->scene = NULL;
    }
    if (!s->scene) {
        s->scene =
            MHD_create_response_from_buffer(b->scene.len, b->scene.at, MHD_RESPMEM_MUST_COPY);
        s->scene_version = version;
        if (!s->scene) {
            return MHD_NO;
        }
        headers_add(s->scene, "application/json");
    }
    return MHD_queue_response(c, MHD_HTTP_OK, s->scene);
}

static enum MHD_Result asset_answer(struct server *s, struct MHD_Connection *c,
                                    const struct asset *asset)
{
    size_t index = (size_t)(asset - assets_at(0));
    return MHD_queue_response(c, MHD_HTTP_OK, s->assets[index]);
}

/* --- the events of a viewer ---------------------------------------------------------------------
 */

/* A viewer that has all of it sleeps until server_run wakes it. */
static ssize_t events_read(void *cls, uint64_t position, char *buffer, size_t size)
{
    struct viewer *viewer = cls;
    struct server *s = viewer->server;
    size_t len = stream_read(&viewer->stream, s->parts.board, buffer, size);
    (void)position;
    if (len == 0 && s->now_ns - viewer->sent_ns >= BEAT_NS) {
        len = 3 <= size ? 3 : size;
        memcpy(buffer, ":\n\n", len);
    }
    if (len == 0) {
        viewer->sleeps = true;
        MHD_suspend_connection(viewer->connection);
        return 0;
    }
    viewer->sent_ns = s->now_ns;
    return (ssize_t)len;
}

static void events_free(void *cls)
{
    viewers_release(cls);
}

static void hello_put(struct server *s, struct viewer *viewer)
{
    char bytes[256], id[20];
    struct mu_json j;
    snprintf(id, sizeof id, "%016llx", (unsigned long long)viewer->id);
    struct mu_text text = mu_text_in(bytes, sizeof bytes);
    mu_text_add(&text, "retry: 1000\n");
    board_event_begin(&text, &j, "hello");
    mu_json_object(&j, NULL);
    mu_json_string(&j, "viewer", id);
    mu_json_string(&j, "version", MU_VERSION);
    mu_json_int(&j, "domain", s->parts.domain);
    mu_json_bool(&j, "read_only", s->parts.guard->read_only);
    mu_json_end(&j);
    board_event_end(&text);
    (void)stream_put(&viewer->stream, &text);
}

static int connection_fd(struct MHD_Connection *c)
{
    return MHD_get_connection_info(c, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
}

static enum MHD_Result events_answer(struct server *s, struct MHD_Connection *c)
{
    struct viewer *viewer = viewers_take(s->parts.viewers);
    if (!viewer) {
        return line_answer(c, MHD_HTTP_SERVICE_UNAVAILABLE, "too many pages are open\n");
    }
    struct MHD_Response *r = MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, SERVER_BLOCK_BYTES,
                                                               events_read, viewer, events_free);
    if (!r) {
        viewers_release(viewer);
        return MHD_NO;
    }
    lobby_leave(&s->lobby, connection_fd(c));
    viewer->connection = c;
    viewer->server = s;
    viewer->sent_ns = s->now_ns;
    hello_put(s, viewer);
    headers_add(r, "text/event-stream; charset=utf-8");
    MHD_set_connection_option(c, MHD_CONNECTION_OPTION_TIMEOUT, (unsigned)SERVER_READ_PATIENCE_S);
    enum MHD_Result queued = MHD_queue_response(c, MHD_HTTP_OK, r);
    MHD_destroy_response(r);
    return queued;
}

/* A page that was refused cannot see why: it asks. */
static enum MHD_Result room_answer(struct server *s, struct MHD_Connection *c)
{
    bool room = viewers_have_room(s->parts.viewers);
    return line_answer(c, room ? MHD_HTTP_OK : MHD_HTTP_SERVICE_UNAVAILABLE, "");
}

/* --- what people do --------------------------------------------------------------------------- */

static uint64_t number_read(struct MHD_Connection *c, const char *header, int base)
{
    const char *value = MHD_lookup_connection_value(c, MHD_HEADER_KIND, header);
    return value ? strtoull(value, NULL, base) : 0;
}

/* The page that asks, and what it calls the question. */
struct asker {
    uint64_t viewer, number;
};

static enum MHD_Result hands_answer(struct server *s, struct MHD_Connection *c, const char *line,
                                    struct asker by)
{
    static const struct {
        mu_result done;
        unsigned status;
    } statuses[] = {{MU_OK, MHD_HTTP_ACCEPTED},
                    {MU_FULL, MHD_HTTP_TOO_MANY_REQUESTS},
                    {MU_ABSENT, MHD_HTTP_NOT_FOUND},
                    {MU_FAULT_USAGE, MHD_HTTP_BAD_REQUEST}};
    struct hands *h = s->parts.hands;
    mu_result done = hands_do(h, line, by.viewer, by.number);
    unsigned status = MHD_HTTP_SERVICE_UNAVAILABLE;
    for (size_t i = 0; i < sizeof statuses / sizeof statuses[0]; i++) {
        status = statuses[i].done == done ? statuses[i].status : status;
    }
    return line_answer(c, status, done == MU_OK ? "" : h->said);
}

static enum consoles_outcome console_act(struct consoles *consoles, const struct target *t,
                                         const char *text, struct asker by)
{
    if (t->route == ROUTE_LINES) {
        return consoles_say(consoles, t->name, text, by.viewer, by.number);
    }
    if (t->route == ROUTE_WORDS) {
        return consoles_complete(consoles, t->name, text, by.viewer, by.number);
    }
    return consoles_watch(consoles, t->name, by.viewer, t->route == ROUTE_WATCH);
}

static enum MHD_Result act_answer(struct server *s, struct MHD_Connection *c,
                                  const struct target *t, const struct request *r)
{
    struct asker by = {number_read(c, "X-Muster-Viewer", 16), number_read(c, "X-Muster-Ask", 10)};
    if (!viewers_find(s->parts.viewers, by.viewer)) {
        return line_answer(c, MHD_HTTP_CONFLICT, "no such viewer: open the page again\n");
    }
    if (memchr(r->body, '\0', r->len)) {
        return line_answer(c, MHD_HTTP_BAD_REQUEST, "expected text\n");
    }
    if (t->route == ROUTE_WORLD) {
        return hands_answer(s, c, r->body, by);
    }
    enum consoles_outcome outcome = console_act(s->parts.consoles, t, r->body, by);
    return line_answer(c, consoles_status(outcome), consoles_text(outcome));
}

/* --- requests --------------------------------------------------------------------------------- */

static enum MHD_Result host_count(void *cls, enum MHD_ValueKind kind, const char *key,
                                  const char *value)
{
    (void)kind;
    (void)value;
    *(unsigned *)cls += strcasecmp(key, "Host") == 0;
    return MHD_YES;
}

static enum guard_verdict request_judge(struct server *s, struct MHD_Connection *c,
                                        const char *method, const struct target *t)
{
    const char *length = MHD_lookup_connection_value(c, MHD_HEADER_KIND, "Content-Length");
    struct guard_request r = {
        .method = method,
        .use = t->use,
        .host = MHD_lookup_connection_value(c, MHD_HEADER_KIND, "Host"),
        .origin = MHD_lookup_connection_value(c, MHD_HEADER_KIND, "Origin"),
        .site = MHD_lookup_connection_value(c, MHD_HEADER_KIND, "Sec-Fetch-Site"),
        .is_entry = t->asset == assets_at(0),
        .token = MHD_lookup_connection_value(c, MHD_HEADER_KIND, "X-Muster-Token"),
        .body_bytes = length ? strtoull(length, NULL, 10) : 0};
    MHD_get_connection_values(c, MHD_HEADER_KIND, host_count, &r.hosts);
    return guard_judge(s->parts.guard, &r);
}

static struct request *request_take(struct server *s)
{
    for (size_t i = 0; i < SERVER_CONNECTIONS_MAX; i++) {
        if (!s->requests[i].used) {
            s->requests[i].used = true;
            s->requests[i].verdict = GUARD_PASSED;
            s->requests[i].len = 0;
            s->requests[i].body[0] = '\0';
            return &s->requests[i];
        }
    }
    return NULL; /* there are as many as connections */
}

/* A body that has not said its length may still be too long. */
static void body_take(struct server *s, struct request *r, const char *bytes, size_t len)
{
    if (r->len + len > GUARD_BODY_MAX) {
        s->parts.guard->refused[GUARD_SIZE] += r->verdict == GUARD_PASSED;
        r->verdict = GUARD_SIZE;
        return;
    }
    memcpy(r->body + r->len, bytes, len);
    r->len += len;
    r->body[r->len] = '\0';
}

/* What a recording says; NULL: it has no such moment, or there is none. */
static enum MHD_Result past_answer(struct MHD_Connection *c, const char *type,
                                   const struct mu_text *text)
{
    return text ? text_answer(c, MHD_HTTP_OK, type, text)
                : line_answer(c, MHD_HTTP_NOT_FOUND, "the recording does not have it\n");
}

static enum MHD_Result recording_answer(struct server *s, struct MHD_Connection *c,
                                        const struct target *t)
{
    struct past *past = s->parts.past;
    if (t->route == ROUTE_WHY) {
        return past_answer(c, "text/plain; charset=utf-8",
                           past ? past_why(past, t->step, t->name) : NULL);
    }
    if (t->route == ROUTE_MOMENTS) {
        return past_answer(c, "application/json",
                           past ? past_moment(past, t->step, t->name) : NULL);
    }
    if (t->route == ROUTE_TRACKS) {
        return past_answer(c, "application/json", past ? past_tracks(past) : NULL);
    }
    struct mu_text none = {.at = (char *)(uintptr_t) "null\n", .len = 5};
    return past_answer(c, "application/json", past ? past_whole(past) : &none);
}

static enum MHD_Result look_answer(struct server *s, struct MHD_Connection *c, const char *method,
                                   const struct target *t)
{
    switch (t->route) {
    case ROUTE_ASSET: return asset_answer(s, c, t->asset);
    case ROUTE_EVENTS: return strcmp(method, "HEAD") == 0 ? room_answer(s, c) : events_answer(s, c);
    case ROUTE_SCENE: return scene_answer(s, c);
    case ROUTE_RECORDING:
    case ROUTE_TRACKS:
    case ROUTE_MOMENTS:
    case ROUTE_WHY: return recording_answer(s, c, t);
    case ROUTE_NONE:
    case ROUTE_LINES:
    case ROUTE_WATCH:
    case ROUTE_LEAVE:
    case ROUTE_WORDS:
    case ROUTE_WORLD: break;
    }
    return MHD_NO;
}

/* The first word of a request: a client is refused before it says more. */
static enum MHD_Result request_begin(struct server *s, struct MHD_Connection *c, const char *method,
                                     const struct target *t, void **own)
{
    enum guard_verdict verdict = request_judge(s, c, method, t);
    if (verdict != GUARD_PASSED) {
        return line_answer(c, guard_status(verdict), guard_text(verdict));
    }
    if (t->use != GUARD_ACT) {
        return look_answer(s, c, method, t);
    }
    *own = request_take(s);
    return *own ? MHD_YES : MHD_NO;
}

static enum MHD_Result on_request(void *cls, struct MHD_Connection *c, const char *path,
                                  const char *method, const char *version, const char *upload,
                                  size_t *upload_len, void **own)
{
    struct server *s = cls;
    struct target t = target_find(path);
    struct request *r = *own;
    (void)version;
    if (!r) {
        return request_begin(s, c, method, &t, own);
    }
    if (*upload_len > 0) {
        body_take(s, r, upload, *upload_len);
        *upload_len = 0;
        return MHD_YES;
    }
    if (r->verdict != GUARD_PASSED) {
        return line_answer(c, guard_status(r->verdict), guard_text(r->verdict));
    }
    return act_answer(s, c, &t, r);
}

/* Our paths have nothing to decode, and what decodes to something else is none of them. */
static size_t on_unescape(void *cls, struct MHD_Connection *c, char *path)
{
    (void)cls;
    (void)c;
    return strlen(path);
}

static void on_completed(void *cls, struct MHD_Connection *c, void **own,
                         enum MHD_RequestTerminationCode how)
{
    struct server *s = cls;
    struct request *r = *own;
    (void)how;
    lobby_enter(&s->lobby, connection_fd(c), s->now_ns);
    if (r) {
        r->used = false;
    }
    *own = NULL;
}

static void on_connection(void *cls, struct MHD_Connection *c, void **own,
                          enum MHD_ConnectionNotificationCode what)
{
    struct server *s = cls;
    (void)own;
    if (what == MHD_CONNECTION_NOTIFY_STARTED) {
        lobby_enter(&s->lobby, connection_fd(c), s->now_ns);
    } else {
        lobby_leave(&s->lobby, connection_fd(c));
    }
}

static void on_log(void *cls, const char *format, va_list args)
{
    char line[256];
    (void)cls;
    vsnprintf(line, sizeof line, format, args);
    line[strcspn(line, "\n")] = '\0';
    mu_log(MU_LOG_DEBUG, "http", "text=\"%s\"", line);
}

/* --- life ------------------------------------------------------------------------------------- */

static mu_result assets_open(struct server *s)
{
    const struct asset *a;
    for (size_t i = 0; (a = assets_at(i)); i++) {
        MU_ASSERT(i < SERVER_ASSETS_MAX);
        s->assets[i] = MHD_create_response_from_buffer(
            (size_t)(a->end - a->bytes), (void *)(uintptr_t)a->bytes, MHD_RESPMEM_PERSISTENT);
        if (!s->assets[i]) {
            return MU_FAULT_OS;
        }
        headers_add(s->assets[i], a->type);
    }
    return MU_OK;
}

mu_result server_open(struct server **out, const struct server_parts *parts, uint16_t port)
{
    struct server *s = mu_startup_alloc(sizeof *s);
    struct sockaddr_in address = {
        .sin_family = AF_INET, .sin_port = htons(port), .sin_addr = {htonl(INADDR_LOOPBACK)}};
    s->parts = *parts;
    MU_TRY(assets_open(s));
    errno = 0;
    s->daemon = MHD_start_daemon(
        MHD_USE_EPOLL | MHD_ALLOW_SUSPEND_RESUME | MHD_USE_ERROR_LOG, port, NULL, NULL, on_request,
        s, MHD_OPTION_EXTERNAL_LOGGER, on_log, NULL, MHD_OPTION_SOCK_ADDR, &address,
        MHD_OPTION_CONNECTION_LIMIT, (unsigned)SERVER_CONNECTIONS_MAX,
        MHD_OPTION_CONNECTION_MEMORY_LIMIT, (size_t)SERVER_HEADER_BYTES,
        MHD_OPTION_CONNECTION_TIMEOUT, (unsigned)SERVER_PATIENCE_S, MHD_OPTION_NOTIFY_COMPLETED,
        on_completed, s, MHD_OPTION_NOTIFY_CONNECTION, on_connection, s,
        MHD_OPTION_UNESCAPE_CALLBACK, on_unescape, NULL, MHD_OPTION_END);
    if (!s->daemon) {
        return errno == EADDRINUSE || errno == EACCES ? MU_BUSY : MU_FAULT_OS;
    }
    *out = s;
    return MU_OK;
}

uint16_t server_port(const struct server *s)
{
    return MHD_get_daemon_info(s->daemon, MHD_DAEMON_INFO_BIND_PORT)->port;
}

int server_fd(const struct server *s)
{
    return MHD_get_daemon_info(s->daemon, MHD_DAEMON_INFO_EPOLL_FD)->epoll_fd;
}

int server_timeout_ms(const struct server *s)
{
    MHD_UNSIGNED_LONG_LONG ms;
    if (MHD_get_timeout(s->daemon, &ms) != MHD_YES) {
        return -1;
    }
    return ms < 60000 ? (int)ms : 60000;
}

static void viewers_wake(struct server *s, bool all)
{
    for (size_t i = 0; i < VIEWERS_MAX; i++) {
        struct viewer *v = &s->parts.viewers->all[i];
        bool due =
            all || stream_has(&v->stream, s->parts.board) || s->now_ns - v->sent_ns >= BEAT_NS;
        if (v->used && v->sleeps && due) {
            v->sleeps = false;
            MHD_resume_connection(v->connection);
        }
    }
}

void server_run(struct server *s, uint64_t now_ns)
{
    s->now_ns = now_ns;
    lobby_round(&s->lobby, now_ns);
    viewers_wake(s, false);
    MHD_run(s->daemon);
}

/* The library wants no thread asleep when it ends. */
void server_close(struct server *s)
{
    viewers_wake(s, true);
    MHD_stop_daemon(s->daemon);
    if (s->scene) {
        MHD_destroy_response(s->scene);
    }
    for (size_t i = 0; i < SERVER_ASSETS_MAX && s->assets[i]; i++) {
        MHD_destroy_response(s->assets[i]);
    }
}
