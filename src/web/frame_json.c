/* SPDX-License-Identifier: Apache-2.0 */
#include "web/json.h"

#include "bus/wire/percept.h"
#include "core/sensors.h"
#include "core/text.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FLAG_STALLED = 8, FLAG_FAULT = 16 };

/* Metres, radians and seconds in thousandths. */
static void milli(struct mu_json *j, double value)
{
    if (isfinite(value) && fabs(value) < 1e15) {
        mu_json_int(j, NULL, llround(value * 1e3));
    } else {
        mu_json_int(j, NULL, 0);
    }
}

static void robot_write(struct mu_json *j, const muster_RobotView *r)
{
    mu_json_list(j, NULL);
    milli(j, r->x_m);
    milli(j, r->y_m);
    milli(j, r->heading_rad);
    milli(j, r->forward_m_s);
    milli(j, r->turn_rad_s);
    milli(j, r->command_forward_m_s);
    milli(j, r->command_turn_rad_s);
    mu_json_int(j, NULL,
                (int)r->state | (r->stalled ? FLAG_STALLED : 0) | (r->fault ? FLAG_FAULT : 0));
    mu_json_end(j);
}

static void places_write(struct mu_json *j, const muster_Frame *f)
{
    mu_json_list(j, "robots");
    for (uint32_t i = 0; i < f->robots._length; i++) {
        robot_write(j, &f->robots._buffer[i]);
    }
    mu_json_end(j);
    mu_json_list(j, "objects");
    for (uint32_t i = 0; i < f->objects._length; i++) {
        const muster_ObjectPlace *o = &f->objects._buffer[i];
        mu_json_list(j, NULL);
        milli(j, o->x_m);
        milli(j, o->y_m);
        milli(j, o->heading_rad);
        mu_json_end(j);
    }
    mu_json_end(j);
}

/* They come in the order of robots, so the search goes on where the last one was found.
 * @return its index, or -1 */
static int64_t robot_find(const muster_Frame *f, const char *name, uint32_t from)
{
    uint32_t count = f->robots._length;
    for (uint32_t n = 0; n < count; n++) {
        uint32_t i = (from + n) % count;
        if (strcmp(f->robots._buffer[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

static void beams_list(struct mu_json *j, const struct mu_channel *c, const muster_Frame *f,
                       bool lean)
{
    char text[BEAMS_TEXT];
    uint32_t from = 0;
    mu_json_list(j, c->fact);
    for (uint32_t i = 0; i < f->percepts._length && !lean; i++) {
        struct mu_percept p;
        size_t count;
        percept_unpack(&p, &f->percepts._buffer[i]);
        const float *readings = mu_channel_list(c, &p, &count);
        int64_t robot = count > 0 ? robot_find(f, p.robot, from) : -1;
        if (robot < 0) {
            continue;
        }
        from = (uint32_t)robot + 1;
        (void)beams_write(text, readings, count);
        mu_json_list(j, NULL);
        mu_json_int(j, NULL, robot);
        mu_json_string(j, NULL, text);
        mu_json_end(j);
    }
    mu_json_end(j);
}

static void lists_write(struct mu_json *j, const muster_Frame *f, bool lean)
{
    mu_json_object(j, "lists");
    for (size_t i = 0; i < MU_CHANNEL_COUNT; i++) {
        if (mu_channels[i].plain) {
            beams_list(j, &mu_channels[i], f, lean);
        }
    }
    mu_json_end(j);
}

/* --- what agents did -------------------------------------------------------------------------- */

static void fired_write(struct mu_json *j, const muster_Frame *f)
{
    uint32_t from = 0;
    mu_json_list(j, "fired");
    for (uint32_t i = 0; i < f->acts._length; i++) {
        const muster_Act *a = &f->acts._buffer[i];
        int64_t robot = a->firings > 0 ? robot_find(f, a->agent, from) : -1;
        if (robot < 0) {
            continue;
        }
        char rules[FRAME_JSON_RULES_MAX + 1];
        from = (uint32_t)robot + 1;
        mu_text_copy(rules, sizeof rules, a->rules);
        mu_json_list(j, NULL);
        mu_json_int(j, NULL, robot);
        mu_json_uint(j, NULL, a->firings);
        mu_json_string(j, NULL, rules);
        mu_json_end(j);
    }
    mu_json_end(j);
}

/* The list is open. */
static void mail_fields(struct mu_json *j, const muster_Mail *m)
{
    char content[FRAME_JSON_CONTENT_MAX + 1];
    mu_text_copy(content, sizeof content, m->content);
    mu_json_string(j, NULL, m->src);
    mu_json_string(j, NULL, m->dst);
    mu_json_string(j, NULL, m->performative);
    mu_json_string(j, NULL, content);
}

static void mail_write(struct mu_json *j, const muster_Mail *m)
{
    mu_json_list(j, NULL);
    mail_fields(j, m);
    mu_json_end(j);
}

void frame_json_mail(struct mu_json *j, int64_t step, const muster_Mail *mail)
{
    mu_json_list(j, NULL);
    mu_json_int(j, NULL, step);
    mail_fields(j, mail);
    mu_json_end(j);
}

/* What comes from outside first, because people sent it. */
static void mails_write(struct mu_json *j, const muster_Frame *f)
{
    uint32_t shown = 0;
    mu_json_list(j, "mails");
    for (uint32_t i = 0; i < f->outside._length && shown < FRAME_JSON_MAILS_MAX; i++, shown++) {
        mail_write(j, &f->outside._buffer[i]);
    }
    for (uint32_t i = 0; i < f->acts._length; i++) {
        const dds_sequence_muster_Mail *mails = &f->acts._buffer[i].mails;
        for (uint32_t k = 0; k < mails->_length && shown < FRAME_JSON_MAILS_MAX; k++, shown++) {
            mail_write(j, &mails->_buffer[k]);
        }
    }
    mu_json_end(j);
}

static void goals_write(struct mu_json *j, const muster_Frame *f)
{
    bool known = false;
    for (uint32_t i = 0; i < f->robots._length && !known; i++) {
        known = f->robots._buffer[i].goal[0] != '\0';
    }
    mu_json_list(j, "goals");
    for (uint32_t i = 0; i < f->robots._length && known; i++) {
        mu_json_string(j, NULL, f->robots._buffer[i].goal);
    }
    mu_json_end(j);
}

static const char *order_text(muster_RunOrder order)
{
    static const char *const texts[] = {
        [muster_RUN_GO] = "go",     [muster_RUN_END] = "end",     [muster_RUN_PLACE] = "place",
        [muster_RUN_PUSH] = "push", [muster_RUN_RESET] = "reset", [muster_RUN_SENSOR] = "sensor",
        [muster_RUN_PACE] = "pace", [muster_RUN_SAVE] = "save",   [muster_RUN_HOLD] = "hold"};
    return (unsigned)order < sizeof texts / sizeof texts[0] ? texts[order] : "unknown";
}

static void orders_write(struct mu_json *j, const muster_Frame *f)
{
    mu_json_list(j, "orders");
    for (uint32_t i = 0; i < f->orders._length && i < FRAME_JSON_MAILS_MAX; i++) {
        const muster_RunCommand *c = &f->orders._buffer[i];
        mu_json_list(j, NULL);
        mu_json_string(j, NULL, c->source);
        mu_json_string(j, NULL, order_text(c->order));
        mu_json_string(j, NULL, c->name);
        mu_json_end(j);
    }
    mu_json_end(j);
}

void frame_json_write(struct mu_json *j, const char *key, const muster_Frame *frame, bool lean)
{
    char digest[17];
    snprintf(digest, sizeof digest, "%016" PRIx64, frame->digest);
    mu_json_object(j, key);
    mu_json_int(j, "step", frame->step);
    mu_json_uint(j, "time_ms", frame->time_ns / 1000000u);
    mu_json_uint(j, "wall_ms", frame->wall_ns / 1000000u);
    mu_json_string(j, "digest", frame->digest ? digest : "");
    places_write(j, frame);
    lists_write(j, frame, lean);
    fired_write(j, frame);
    mails_write(j, frame);
    goals_write(j, frame);
    orders_write(j, frame);
    mu_json_end(j);
}

void frame_json_totals(struct mu_json *j, const char *key, const muster_Frame *frame)
{
    mu_json_object(j, key);
    mu_json_uint(j, "time_ms", frame->time_ns / 1000000u);
    mu_json_list(j, "robots");
    for (uint32_t i = 0; i < frame->robots._length; i++) {
        const muster_RobotView *r = &frame->robots._buffer[i];
        mu_json_list(j, NULL);
        milli(j, r->distance_m);
        mu_json_uint(j, NULL, r->stalls);
        milli(j, r->stalled_s);
        mu_json_uint(j, NULL, r->firings);
        mu_json_uint(j, NULL, r->mails_sent);
        mu_json_uint(j, NULL, r->mails_received);
        mu_json_end(j);
    }
    mu_json_end(j);
    mu_json_end(j);
}
