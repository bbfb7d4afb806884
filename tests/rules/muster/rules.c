/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Runs rule files against a body and a post office that are not there, and compares what they do
 * with the comments in them:
 *
 *   ; options: library=no body=no budget=3 failures=3    before everything else; all are optional
 *   ; fails: 7 text                   the file is refused at line 7, and the message holds the text
 *   ; mail: red mate-pos red 1.0 2.0  arrives in the next step
 *   ; speech: ask-one q1 red what     the same with a performative and a reply-with
 *   ; text: red plain any words       the same in another language than clips
 *   ; layer: 4 cfp q1 red price       the same in a layer, with a performative and a reply-with
 *   ; envelope: conversation=c1 language=sl ontology=o in-reply-to=q0 reply-by=9   parameters of
 * the mail above it ; resolve: low red              the broker asks for whom SCHEME:low stands in a
 * mail of red ; event: on-run                   happens to the robot ; refused: group-create north
 * group-exists   what the broker says to a change ; step: x=100 heading=90 sonar=5000 s3=400
 * stalled=1   one control step; mm, deg; values stay (also ox oy oheading: the odometer; bumpers
 * gripper battery) ; steps: 50                       so many ; line: (follow red)              what
 * a person types ; facts: goal                     what another agent asks for; no word: all facts
 *   ; laser: 500 1000               what the beams read from now on if rules look at it; mm
 *   ; list: laser 0.5 1             the same for any plain list of the table of sensors; as in C
 *   ; blob: ff0000 10 5 1500        one more in the camera: rgb, bearing, width deg, range mm; or
 * none ; fiducial: 7 10 1500 90        likewise: number, bearing deg, range mm, heading deg ;
 * senses:                       prints which sensors the rules look at ; acts: on each step also
 * says why it ended and which rules fired ; expect: text                    the next line of output
 *
 * Output is what rules print, the answers to lines, `speed V W` (mm/s, deg/s), `gripper PADDLES
 * LIFT` (1 close or up, -1 open or down), `mail TO "content"`, `do WHO "line"`, `change WHAT NAME
 * "attributes"`, and what becomes of a mail that is not kept. The file is loaded over the library
 * as a robot's rule file, then its comments are done in order. Output that no expect: names is a
 * failure.
 */
#include "core/attributes.h"
#include "core/sensors.h"
#include "core/text_file.h"
#include "mind/mind.h"
#include "muster/limits.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    LINES_MAX = 512,
    LINE_MAX_BYTES = 4096,
    MAILS_MAX = 64,
    FILES_MAX = 256,
    SONARS = 16,
    BEAMS = 8
};

static const double deg = 180 / 3.14159265358979323846;

struct waiting {
    char from[64], performative[64], reply_with[64], language[64];
    char ontology[64], in_reply_to[64], conversation[64];
    double reply_by_s;
    char content[LINE_MAX_BYTES];
    uint32_t layer;
};

struct bench {
    const char *file;
    int line;
    struct mind *mind;
    unsigned passed, failed;
    /* what came out and was not yet expected */
    char output[LINES_MAX][LINE_MAX_BYTES];
    size_t first, count;
    char part[LINE_MAX_BYTES]; /* of a line that is not complete */
    /* the body */
    double x_mm, y_mm, heading_deg, speed_mm_s, turn_deg_s;
    float sonar_m[SONARS];
    double odometer_x_mm, odometer_y_mm, odometer_deg, bumpers, gripper, battery;
    float lists[MU_CHANNEL_COUNT][BEAMS];
    size_t counts[MU_CHANNEL_COUNT];
    struct mu_blob blobs[MU_BLOBS_MAX];
    struct mu_fiducial fiducials[MU_FIDUCIALS_MAX];
    size_t blob_count, fiducial_count;
    uint32_t senses; /* that the simulator was asked for with the last step */
    bool stalled, acts, bodiless;
    uint64_t steps, mail_id;
    struct waiting mails[MAILS_MAX];
    size_t mail_count;
};

static struct bench bench;
static struct mind *minds[FILES_MAX]; /* a mind's memory is for the life of the process */
static size_t mind_count;

static void out_line(struct bench *b, const char *text)
{
    if (b->count < LINES_MAX) {
        mu_text_copy(b->output[b->count++], LINE_MAX_BYTES, text);
    }
}

static void out_print(void *self, const char *text)
{
    struct bench *b = self;
    for (; *text; text++) {
        size_t len = strlen(b->part);
        if (*text == '\n') {
            out_line(b, b->part);
            b->part[0] = '\0';
        } else if (len + 1 < sizeof b->part) {
            b->part[len] = *text;
            b->part[len + 1] = '\0';
        }
    }
}

static void out_flush(struct bench *b)
{
    if (b->part[0]) {
        out_line(b, b->part);
        b->part[0] = '\0';
    }
}

static mu_result post(void *self, const struct mind_letter *letter)
{
    char bytes[LINE_MAX_BYTES];
    struct mu_text t;
    mu_text_init(&t, bytes, sizeof bytes);
    if (strcmp(letter->dst, "nobody") == 0) {
        return MU_FULL;
    }
    mu_text_format(&t, "%s %s", letter->directive ? letter->performative : "mail", letter->dst);
    const char *const parts[][2] = {
        {"", letter->directive ? "" : letter->performative},
        {"language=", strcmp(letter->language, "clips") == 0 ? "" : letter->language},
        {"ontology=", letter->ontology},
        {"reply-with=", letter->reply_with},
        {"in-reply-to=", letter->in_reply_to},
        {"conversation=", letter->conversation},
    };
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        if (parts[i][1][0]) {
            mu_text_format(&t, " %s%s", parts[i][0], parts[i][1]);
        }
    }
    static const char *const levels[] = {"ram", "logged", "synced"};
    if (letter->layer && letter->layer != MU_LAYER_SPEECH) {
        mu_text_format(&t, " layer=%u", (unsigned)letter->layer);
    }
    if (letter->priority) {
        mu_text_format(&t, " priority=%d", letter->priority);
    }
    if (letter->level) {
        mu_text_format(&t, " level=%s", levels[letter->level]);
    }
    if (letter->reply_by_ns) {
        mu_text_format(&t, " reply-by=%.1f", (double)letter->reply_by_ns * 1e-9);
    }
    if (letter->ttl_ns) {
        mu_text_format(&t, " ttl=%.1f", (double)letter->ttl_ns * 1e-9);
    }
    mu_text_format(&t, " \"%s\"", letter->content);
    out_flush(self);
    out_line(self, t.at);
    return MU_OK;
}

/* A small society, in order of name. */
static const struct mind_member members[] = {
    {"blue", "robot", "running", "here"},
    {"green", "robot", "standby", "there"},
    {"red", "robot", "running", "here"},
};

static mu_result listing(void *self, size_t index, struct mind_member *out)
{
    (void)self;
    if (index >= sizeof members / sizeof members[0]) {
        return MU_DONE;
    }
    *out = members[index];
    return MU_OK;
}

static mu_result lookup(void *self, const char *name, struct mind_member *out)
{
    for (size_t i = 0; listing(self, i, out) == MU_OK; i++) {
        if (strcmp(out->name, name) == 0) {
            return MU_OK;
        }
    }
    return MU_ABSENT;
}

/* Its groups, and its yellow pages in order of service and agent. */
static const char *const group_members[][2] = {
    {"north", "blue"}, {"north", "red"}, {"observer", "red"}, {"scouts", "green"}};
static const char *const group_names[] = {"north", "observer", "scouts"};
static const char *const offers[][3] = {{"camera", "green", "x=1 y=2"},
                                        {"mapper", "green", "role=scout battery=0.8"},
                                        {"mapper", "red", "role=digger battery=0.4 x=5 y=5"}};

static const char *provider(const char *text, size_t index)
{
    struct mu_query query;
    size_t found = 0;
    if (mu_attributes_query(&query, text) != MU_OK) {
        return NULL;
    }
    for (size_t i = 0; i < sizeof offers / sizeof offers[0]; i++) {
        if (mu_attributes_match(&query, offers[i][0], offers[i][2]) && found++ == index) {
            return offers[i][1];
        }
    }
    return NULL;
}

static const char *entry(void *self, enum mind_list list, const char *of, size_t index)
{
    (void)self;
    size_t found = 0;
    if (list == MIND_PROVIDERS) {
        return provider(of, index);
    }
    if (list == MIND_GROUPS) {
        return index < sizeof group_names / sizeof group_names[0] ? group_names[index] : NULL;
    }
    for (size_t i = 0; i < sizeof group_members / sizeof group_members[0]; i++) {
        if (strcmp(group_members[i][0], of) == 0 && found++ == index) {
            return group_members[i][1];
        }
    }
    return NULL;
}

static mu_result change(void *self, enum mind_change what, const char *name, const char *attributes,
                        uint64_t lease_ns)
{
    static const char *const words[] = {"group-create", "group-join", "group-leave",
                                        "advertise",    "withdraw",   "resolve"};
    char bytes[LINE_MAX_BYTES];
    struct mu_text t;
    if (strcmp(name, "nobody") == 0) {
        return MU_FULL;
    }
    mu_text_init(&t, bytes, sizeof bytes);
    mu_text_format(&t, "change %s %s \"%s\"", words[what], name, attributes);
    if (lease_ns) {
        mu_text_format(&t, " lease=%.1f", (double)lease_ns * 1e-9);
    }
    out_flush(self);
    out_line(self, t.at);
    return MU_OK;
}

static void complain(struct bench *b, const char *want, const char *got)
{
    b->failed++;
    printf("%s:%d:\n  want: %s\n  got:  %s\n", b->file, b->line, want, got);
}

/* Whatever is left was not expected. */
static void settle(struct bench *b)
{
    out_flush(b);
    for (; b->first < b->count; b->first++) {
        complain(b, "(nothing)", b->output[b->first]);
    }
    b->first = 0;
    b->count = 0;
}

static void do_expect(struct bench *b, const char *text)
{
    out_flush(b);
    const char *got = b->first < b->count ? b->output[b->first++] : "(nothing)";
    if (strcmp(text, got) == 0) {
        b->passed++;
    } else {
        complain(b, text, got);
    }
}

static void show_act(struct bench *b, const struct mind_act *act)
{
    static const char *const ends[] = {"idle", "sense-again", "budget", "stopped", "break"};
    char line[LINE_MAX_BYTES];
    struct mu_text t;
    mu_text_init(&t, line, sizeof line);
    if (act->drives) {
        /* + 0.0: no negative zero */
        mu_text_format(&t, "speed %.6g %.6g", act->forward_m_s * 1000 + 0.0,
                       act->turn_rad_s * deg + 0.0);
        out_line(b, line);
    }
    if (act->paddles || act->lift) {
        mu_text_clear(&t);
        mu_text_format(&t, "gripper %d %d", (int)act->paddles, (int)act->lift);
        out_line(b, line);
    }
    if (b->acts) {
        mu_text_clear(&t);
        mu_text_format(&t, "%s%s%s, %u fired, %u errors:%s%.200s", ends[act->end],
                       act->why ? " " : "", act->why ? act->why : "", act->firings, act->errors,
                       act->rules[0] ? " " : "", act->rules);
        out_line(b, line);
    }
    if (act->enough) {
        mu_text_clear(&t);
        mu_text_format(&t, "enough: %s", act->enough);
        out_line(b, line);
    }
}

/* As a robot does; what it knows of layers 1 and 2 by itself is not here. */
static void receive(struct bench *b, const struct mind_mail *mail)
{
    if (mind_handle(b->mind, mail)) {
        return;
    }
    if (!mind_understands(b->mind, mail)) {
        out_flush(b);
        out_line(b, "not understood");
    } else if (mind_take_mail(b->mind, mail) != MU_OK) {
        out_line(b, "mail refused");
    }
}

static void step(struct bench *b)
{
    struct mind_act act;
    struct mu_percept p = {.time_ns = b->steps++ * MU_STEP_NS,
                           .x_m = b->x_mm / 1000,
                           .y_m = b->y_mm / 1000,
                           .heading_rad = b->heading_deg / deg,
                           .forward_m_s = b->speed_mm_s / 1000,
                           .turn_rad_s = b->turn_deg_s / deg,
                           .stalled = b->stalled,
                           .gps_x_m = b->x_mm / 1000,
                           .gps_y_m = b->y_mm / 1000,
                           .compass_rad = b->heading_deg / deg,
                           .odometer_x_m = b->odometer_x_mm / 1000,
                           .odometer_y_m = b->odometer_y_mm / 1000,
                           .odometer_heading_rad = b->odometer_deg / deg,
                           .battery_share = b->battery,
                           .bumpers = (uint32_t)b->bumpers,
                           .gripper = (uint32_t)b->gripper,
                           .blob_count = b->senses & MU_SENSE_CAMERA ? b->blob_count : 0,
                           .blobs = b->blobs,
                           .fiducial_count = b->senses & MU_SENSE_FIDUCIALS ? b->fiducial_count : 0,
                           .fiducials = b->fiducials,
                           .sonar_count = SONARS,
                           .sonar_m = b->sonar_m};
    for (size_t i = 0; i < MU_CHANNEL_COUNT; i++) {
        const struct mu_channel *c = &mu_channels[i];
        if (b->counts[i] > 0 && (b->senses & c->senses) == c->senses) {
            mu_channel_set(c, &p, b->lists[i], b->counts[i]);
        }
    }
    if (b->bodiless) {
        mind_feel_nothing(b->mind, p.time_ns);
    } else {
        mind_percept(b->mind, &p);
    }
    for (size_t i = 0; i < b->mail_count; i++) {
        const struct waiting *w = &b->mails[i];
        struct mind_mail mail = {.id = ++b->mail_id,
                                 .src = w->from,
                                 .performative = w->performative,
                                 .language = w->language,
                                 .ontology = w->ontology,
                                 .reply_with = w->reply_with,
                                 .in_reply_to = w->in_reply_to,
                                 .conversation = w->conversation,
                                 .content = w->content,
                                 .reply_by_ns = (uint64_t)(w->reply_by_s * 1e9),
                                 .layer = w->layer};
        receive(b, &mail);
    }
    b->mail_count = 0;
    mind_fire(b->mind, &act);
    b->senses = mind_senses(b->mind);
    out_flush(b);
    show_act(b, &act);
}

static void set_sonar(struct bench *b, int index, double mm)
{
    for (int i = 0; i < SONARS; i++) {
        b->sonar_m[i] = i == index || index < 0 ? (float)(mm / 1000) : b->sonar_m[i];
    }
}

static void set_value(struct bench *b, const char *key, double value)
{
    const struct {
        const char *key;
        double *at;
    } numbers[] = {{"x", &b->x_mm},
                   {"y", &b->y_mm},
                   {"heading", &b->heading_deg},
                   {"speed", &b->speed_mm_s},
                   {"turn", &b->turn_deg_s},
                   {"ox", &b->odometer_x_mm},
                   {"oy", &b->odometer_y_mm},
                   {"oheading", &b->odometer_deg},
                   {"bumpers", &b->bumpers},
                   {"gripper", &b->gripper},
                   {"battery", &b->battery}};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        if (strcmp(key, numbers[i].key) == 0) {
            *numbers[i].at = value;
            return;
        }
    }
    if (strcmp(key, "stalled") == 0) {
        b->stalled = value != 0;
    } else if (strcmp(key, "sonar") == 0) {
        set_sonar(b, -1, value);
    } else if (key[0] == 's' && strspn(key + 1, "0123456789") == strlen(key + 1)) {
        set_sonar(b, (int)strtol(key + 1, NULL, 10), value);
    } else {
        complain(b, "a key of step:", key);
    }
}

static void do_step(struct bench *b, const char *text)
{
    char key[32];
    double value;
    int len;
    while (sscanf(text, " %31[a-z0-9]=%lf%n", key, &value, &len) == 2) {
        set_value(b, key, value);
        text += len;
    }
    step(b);
}

static void do_steps(struct bench *b, const char *text)
{
    for (long n = strtol(text, NULL, 10); n > 0; n--) {
        step(b);
    }
}

/* Cuts the first word off. */
static const char *cut_word(const char *text, char *word, size_t size)
{
    size_t len = strcspn(text, " ");
    snprintf(word, size, "%.*s", (int)len, text);
    return text + len + (text[len] == ' ');
}

static struct waiting *new_mail(struct bench *b)
{
    struct waiting *w = &b->mails[b->mail_count < MAILS_MAX - 1 ? b->mail_count++ : MAILS_MAX - 1];
    *w = (struct waiting){.from = ""};
    return w;
}

static void do_mail(struct bench *b, const char *text)
{
    struct waiting *w = new_mail(b);
    mu_text_copy(w->content, sizeof w->content, cut_word(text, w->from, sizeof w->from));
}

static void do_speech(struct bench *b, const char *text)
{
    struct waiting *w = new_mail(b);
    text = cut_word(text, w->performative, sizeof w->performative);
    text = cut_word(text, w->reply_with, sizeof w->reply_with);
    mu_text_copy(w->content, sizeof w->content, cut_word(text, w->from, sizeof w->from));
}

static void do_layer(struct bench *b, const char *text)
{
    char *rest;
    struct waiting *w = new_mail(b);
    w->layer = (uint32_t)strtoul(text, &rest, 10);
    text = cut_word(rest + (*rest == ' '), w->performative, sizeof w->performative);
    text = cut_word(text, w->reply_with, sizeof w->reply_with);
    mu_text_copy(w->content, sizeof w->content, cut_word(text, w->from, sizeof w->from));
}

/* Sets parameters of the youngest mail. */
static void do_envelope(struct bench *b, const char *text)
{
    struct waiting *w = &b->mails[b->mail_count - 1];
    char word[128];
    const struct {
        const char *key;
        char *to;
    } words[] = {{"conversation=", w->conversation},
                 {"language=", w->language},
                 {"ontology=", w->ontology},
                 {"in-reply-to=", w->in_reply_to}};
    while (*text) {
        text = cut_word(text, word, sizeof word);
        for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
            size_t len = strlen(words[i].key);
            if (strncmp(word, words[i].key, len) == 0) {
                mu_text_copy(words[i].to, sizeof w->ontology, word + len);
            }
        }
        if (strncmp(word, "reply-by=", 9) == 0) {
            w->reply_by_s = strtod(word + 9, NULL);
        }
    }
}

static void do_resolve(struct bench *b, const char *text)
{
    char rest[64], names[LINE_MAX_BYTES];
    const char *sender = cut_word(text, rest, sizeof rest);
    struct mu_text out = mu_text_in(names, sizeof names);
    bool known = mind_resolve(b->mind, rest, sender, &out);
    out_flush(b);
    out_line(b, known ? names : "no such address");
}

/* What cannot wait for a step does not. */
static void do_event(struct bench *b, const char *text)
{
    static const char *const names[MU_EVENTS] = {"on-create", "on-run",   "on-arrive",
                                                 "on-leave",  "on-clone", "on-dispose"};
    struct mind_act act;
    for (size_t i = 0; i < MU_EVENTS; i++) {
        if (strcmp(names[i], text) != 0) {
            continue;
        }
        if (i == MU_ON_LEAVE || i == MU_ON_DISPOSE) {
            mind_event_now(b->mind, (enum mu_event)i, &act);
        } else {
            mind_event(b->mind, (enum mu_event)i);
        }
        return;
    }
    complain(b, "an event", text);
}

static void do_refused(struct bench *b, const char *text)
{
    char words[64];
    const char *last = strrchr(text, ' ');
    snprintf(words, sizeof words, "%.*s", last ? (int)(last - text) : 0, text);
    mind_refused(b->mind, words, last ? last + 1 : "");
}

static void do_facts(struct bench *b, const char *text)
{
    static char bytes[LINES_MAX * 64];
    struct mu_text out;
    mu_text_init(&out, bytes, sizeof bytes);
    mu_result r = mind_facts(b->mind, text, &out);
    out_print(b, bytes);
    out_flush(b);
    if (r != MU_OK) {
        out_line(b, "refused");
    }
}

static void do_text(struct bench *b, const char *text)
{
    struct waiting *w = new_mail(b);
    text = cut_word(text, w->from, sizeof w->from);
    mu_text_copy(w->content, sizeof w->content, cut_word(text, w->language, sizeof w->language));
}

static void do_line(struct bench *b, const char *text)
{
    static char bytes[LINES_MAX * 64];
    struct mu_text out;
    mu_text_init(&out, bytes, sizeof bytes);
    mu_result r = mind_line(b->mind, text, &out);
    out_flush(b);
    out_print(b, bytes);
    out_flush(b);
    if (r != MU_OK) {
        out_line(b, "refused");
    }
    static const char *const wishes[] = {NULL, "wants to run", "wants to step", "wants to suspend"};
    uint32_t rules;
    enum mind_wish wish = mind_wish(b->mind, &rules);
    if (wish != MIND_WISH_NOTHING) {
        out_line(b, wishes[wish]);
        mind_go_on(b->mind);
    }
}

static void do_laser(struct bench *b, const char *text)
{
    double mm;
    int len;
    size_t *count = &b->counts[MU_CHANNEL_LASER];
    for (*count = 0; *count < BEAMS && sscanf(text, "%lf%n", &mm, &len) == 1; text += len) {
        b->lists[MU_CHANNEL_LASER][(*count)++] = (float)(mm / 1000);
    }
}

static void do_list(struct bench *b, const char *text)
{
    for (size_t i = 0; i < MU_CHANNEL_COUNT; i++) {
        const char *at = text + strlen(mu_channels[i].fact);
        int len;
        if (!mu_channels[i].plain || at[0] != ' ' ||
            strncmp(text, mu_channels[i].fact, (size_t)(at - text)) != 0) {
            continue;
        }
        for (b->counts[i] = 0;
             b->counts[i] < BEAMS && sscanf(at, "%f%n", &b->lists[i][b->counts[i]], &len) == 1;
             at += len) {
            b->counts[i]++;
        }
    }
}

/* Adds one; without words all are gone. */
static void do_blob(struct bench *b, const char *text)
{
    unsigned rgb;
    double bearing_deg, width_deg, range_mm;
    if (sscanf(text, "%x %lf %lf %lf", &rgb, &bearing_deg, &width_deg, &range_mm) != 4) {
        b->blob_count = 0;
    } else if (b->blob_count < MU_BLOBS_MAX) {
        b->blobs[b->blob_count++] =
            (struct mu_blob){rgb, bearing_deg / deg, width_deg / deg, range_mm / 1000};
    }
}

static void do_fiducial(struct bench *b, const char *text)
{
    int number;
    double bearing_deg, range_mm, heading_deg;
    if (sscanf(text, "%d %lf %lf %lf", &number, &bearing_deg, &range_mm, &heading_deg) != 4) {
        b->fiducial_count = 0;
    } else if (b->fiducial_count < MU_FIDUCIALS_MAX) {
        b->fiducials[b->fiducial_count++] =
            (struct mu_fiducial){number, bearing_deg / deg, range_mm / 1000, heading_deg / deg};
    }
}

static void do_senses(struct bench *b, const char *text)
{
    char line[128] = "senses";
    (void)text;
#define ADD(id, word, ...)                                                      \
    if (mind_senses(b->mind) & MU_SENSE_##id) {                                 \
        snprintf(line + strlen(line), sizeof line - strlen(line), " %s", word); \
    }
    MU_SENSORS(ADD)
#undef ADD
    out_line(b, line);
}

static void do_acts(struct bench *b, const char *text)
{
    b->acts = strcmp(text, "on") == 0;
}

static const struct {
    const char *word;
    void (*call)(struct bench *b, const char *text);
} directives[] = {{"step", do_step},     {"steps", do_steps},       {"mail", do_mail},
                  {"speech", do_speech}, {"text", do_text},         {"line", do_line},
                  {"layer", do_layer},   {"event", do_event},       {"refused", do_refused},
                  {"facts", do_facts},   {"acts", do_acts},         {"laser", do_laser},
                  {"blob", do_blob},     {"fiducial", do_fiducial}, {"senses", do_senses},
                  {"list", do_list},     {"envelope", do_envelope}, {"resolve", do_resolve}};

/* One line of the file; a comment that is a directive is done. */
static void do_file_line(struct bench *b, const char *line)
{
    char word[16];
    int len = 0;
    if (sscanf(line, "; %15[a-z]:%n", word, &len) != 1 || len == 0) {
        return;
    }
    const char *text = line + len + (line[len] == ' ');
    if (strcmp(word, "expect") == 0) {
        do_expect(b, text);
        return;
    }
    for (size_t i = 0; i < sizeof directives / sizeof directives[0]; i++) {
        if (strcmp(word, directives[i].word) == 0) {
            settle(b);
            directives[i].call(b, text);
        }
    }
}

/* Finds the text of a directive that stands before all others, or NULL. */
static const char *find_header(FILE *f, const char *word, char *line, size_t size, int *number)
{
    rewind(f);
    for (*number = 1; fgets(line, (int)size, f); (*number)++) {
        line[strcspn(line, "\n")] = '\0';
        if (strncmp(line, "; ", 2) == 0 && strncmp(line + 2, word, strlen(word)) == 0) {
            return line + 2 + strlen(word);
        }
    }
    return NULL;
}

static bool expect_fault(struct bench *b, FILE *f, mu_result r, const struct mu_fault *fault)
{
    char line[LINE_MAX_BYTES];
    char got[1024];
    char *rest;
    const char *fails = find_header(f, "fails: ", line, sizeof line, &b->line);
    snprintf(got, sizeof got, "%d %s", fault->line, r == MU_OK ? "loaded" : fault->text);
    if (!fails) {
        if (r != MU_OK) {
            complain(b, "a file that loads", got);
        }
        return r != MU_OK;
    }
    long number = strtol(fails, &rest, 10);
    if (r != MU_OK && fault->line == number && strstr(fault->text, rest + (*rest == ' '))) {
        b->passed++;
    } else {
        complain(b, fails, got);
    }
    return true;
}

/* @return the number of an option; 0 when it is not there */
static unsigned option_of(const char *options, const char *name)
{
    const char *at = options ? strstr(options, name) : NULL;
    return at ? (unsigned)strtoul(at + strlen(name), NULL, 10) : 0;
}

static mu_result load(struct bench *b, FILE *f, struct mu_fault *fault)
{
    char line[LINE_MAX_BYTES];
    int number;
    const char *options = find_header(f, "options: ", line, sizeof line, &number);
    bool library = !options || !strstr(options, "library=no");
    b->bodiless = options && strstr(options, "body=no");
    struct mind_options o = {.read = mu_text_file_read,
                             .name = "blue",
                             .seed = 1,
                             .rules_folder = library ? "rules" : NULL,
                             .firings_max = option_of(options, "budget="),
                             .failures_max = option_of(options, "failures="),
                             .forward_max_m_s = 0.5,
                             .turn_max_rad_s = 90 / deg,
                             .ports = {.self = b,
                                       .send = post,
                                       .lookup = lookup,
                                       .listing = listing,
                                       .change = change,
                                       .entry = entry,
                                       .print = out_print}};
    mu_result r = mind_open(&b->mind, &o, fault);
    minds[mind_count++] = b->mind;
    return r == MU_OK ? mind_load(b->mind, b->file, fault) : r;
}

static void run_file(struct bench *b, const char *path)
{
    static char line[LINE_MAX_BYTES * 8];
    struct mu_fault fault = {.line = 0};
    unsigned passed = b->passed;
    unsigned failed = b->failed;
    *b = (struct bench){
        .file = path, .passed = passed, .failed = failed, .battery = -1, .senses = MU_SENSE_SONAR};
    set_sonar(b, -1, 5000);
    FILE *f = fopen(path, "r");
    if (!f) {
        complain(b, "a file that can be opened", path);
        return;
    }
    mu_result r = load(b, f, &fault);
    if (!expect_fault(b, f, r, &fault)) {
        rewind(f);
        for (b->line = 1; fgets(line, sizeof line, f); b->line++) {
            line[strcspn(line, "\n")] = '\0';
            do_file_line(b, line);
        }
        settle(b);
    }
    fclose(f);
    mind_close(b->mind);
}

int main(int argc, char **argv)
{
    for (int i = 1; i < argc && i < FILES_MAX; i++) {
        run_file(&bench, argv[i]);
    }
    printf("%u passed, %u failed\n", bench.passed, bench.failed);
    return bench.failed > 0 || bench.passed == 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}
