/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/record/record.h"

#include "muster/limits.h"
#include "muster/memory.h"

#include <string.h>

enum { FRAME_NONE = -1 };

/* An arena: memory is handed out from its beginning, and taken back all at once. */
struct pool_bytes {
    unsigned char *bytes;
    size_t size, used;
    bool cut; /* something did not fit */
};

/* The acts of one robot, in the order in which they came. */
struct chain {
    int32_t first, last;
};

/* Mails from outside.  The broker may be a step ahead, so there are two of these. */
struct outside {
    struct pool_bytes text;
    int64_t step;
    muster_Mail mails[MU_FRAME_MAILS_MAX];
    uint32_t count;
};

struct frame_builder {
    muster_Frame frame;
    struct pool_bytes text;
    size_t robot_count;
    size_t chains_count;             /* in use: of the robots, then of agents without a body */
    struct chain *chains;            /* of each */
    int32_t next[MU_FRAME_ACTS_MAX]; /* in the chain */
    muster_Act acts[MU_FRAME_ACTS_MAX];
    muster_Act sorted[MU_FRAME_ACTS_MAX];
    uint32_t act_count;
    struct outside outside[2]; /* of even and odd steps */
    struct order orders[MU_ORDERS_MAX];
    uint32_t order_count;
    muster_RunCommand orders_out[MU_ORDERS_MAX];
    uint64_t left_out;
};

/* --- memory ----------------------------------------------------------------------------------- */

static void *bytes_take(struct pool_bytes *p, size_t count)
{
    count = (count + 7) & ~(size_t)7;
    if (p->cut || count > p->size - p->used) {
        p->cut = true;
        return NULL;
    }
    void *taken = p->bytes + p->used;
    p->used += count;
    return taken;
}

/* NULL stands for the empty text, as on the wire. */
static char *text_keep(struct pool_bytes *p, const char *text)
{
    static char none[1];
    size_t bytes = text ? strlen(text) + 1 : 1;
    char *copy = bytes > 1 ? bytes_take(p, bytes) : NULL;
    if (!copy) {
        return none;
    }
    memcpy(copy, text, bytes);
    return copy;
}

static muster_Mail mail_keep(struct pool_bytes *p, const muster_Mail *m)
{
    muster_Mail copy = *m;
    copy.src = text_keep(p, m->src);
    copy.dst = text_keep(p, m->dst);
    copy.performative = text_keep(p, m->performative);
    copy.language = text_keep(p, m->language);
    copy.ontology = text_keep(p, m->ontology);
    copy.reply_with = text_keep(p, m->reply_with);
    copy.in_reply_to = text_keep(p, m->in_reply_to);
    copy.conversation = text_keep(p, m->conversation);
    copy.content = text_keep(p, m->content);
    return copy;
}

/* Takes back what was begun if not all of it fitted.  @return whether all fitted */
static bool bytes_settle(struct pool_bytes *p, size_t before)
{
    bool whole = !p->cut;
    p->used = whole ? p->used : before;
    p->cut = false;
    return whole;
}

/* --- opening ---------------------------------------------------------------------------------- */

static void chains_clear(struct frame_builder *v)
{
    for (size_t i = 0; i < v->chains_count; i++) {
        v->chains[i] = (struct chain){FRAME_NONE, FRAME_NONE};
    }
    v->chains_count = v->robot_count;
    v->act_count = 0;
    v->text.used = 0;
}

static void lines_open(struct frame_builder *v, const struct world *world, size_t agents)
{
    muster_Frame *f = &v->frame;
    f->robots._buffer = mu_startup_array(world->robot_count, sizeof *f->robots._buffer);
    f->robots._length = f->robots._maximum = (uint32_t)world->robot_count;
    f->agents._buffer = mu_startup_array(agents, sizeof *f->agents._buffer);
    f->agents._length = f->agents._maximum = (uint32_t)agents;
    f->percepts._buffer = mu_startup_array(world->robot_count, sizeof *f->percepts._buffer);
    f->objects._buffer = mu_startup_array(world->object_count, sizeof *f->objects._buffer);
    f->objects._length = f->objects._maximum = (uint32_t)world->object_count;
    for (size_t i = 0; i < world->robot_count; i++) {
        f->robots._buffer[i].name = (char *)(uintptr_t)world->robots[i].name; /* it is only read */
        f->robots._buffer[i].goal = (char *)(uintptr_t) "";
    }
    for (size_t i = 0; i < world->object_count; i++) {
        f->objects._buffer[i].name = (char *)(uintptr_t)world->objects[i].name;
    }
}

struct frame_builder *frame_open(const struct world *world, const char *simulator, size_t agents)
{
    struct frame_builder *v = mu_startup_alloc(sizeof *v);
    v->frame.simulator = (char *)(uintptr_t)simulator;
    v->robot_count = world->robot_count;
    v->chains_count = world->robot_count + MU_AGENTS_MAX;
    v->chains = mu_startup_array(v->chains_count, sizeof *v->chains);
    v->text.bytes = mu_startup_alloc(MU_FRAME_BYTES_MAX);
    v->text.size = MU_FRAME_BYTES_MAX;
    for (size_t i = 0; i < 2; i++) {
        v->outside[i].text.size = MU_FRAME_BYTES_MAX / 8;
        v->outside[i].text.bytes = mu_startup_alloc(v->outside[i].text.size);
        v->outside[i].step = -1;
    }
    lines_open(v, world, agents);
    chains_clear(v);
    return v;
}

/* --- what comes in ---------------------------------------------------------------------------- */

void frame_begin(struct frame_builder *v, int64_t step, uint64_t time_ns)
{
    v->frame.step = step;
    v->frame.time_ns = time_ns;
    v->frame.percepts._length = 0;
    v->order_count = 0;
}

void frame_take_body(struct frame_builder *v, size_t robot, const struct engine_sample *sample,
                     const struct tally *tally)
{
    muster_RobotView *r = &v->frame.robots._buffer[robot];
    r->x_m = sample->pose.x_m;
    r->y_m = sample->pose.y_m;
    r->heading_rad = sample->pose.heading_rad;
    r->forward_m_s = sample->percept.forward_m_s;
    r->turn_rad_s = sample->percept.turn_rad_s;
    r->stalled = sample->percept.stalled;
    r->fault = sample->percept.fault;
    r->placed = sample->placed;
    r->distance_m = tally->distance_m;
    r->stalled_s = tally->stalled_s;
    r->stalls = tally->stalls;
}

void frame_take_object(struct frame_builder *v, size_t object, struct world_pose pose)
{
    muster_ObjectPlace *o = &v->frame.objects._buffer[object];
    o->x_m = pose.x_m;
    o->y_m = pose.y_m;
    o->heading_rad = pose.heading_rad;
}

void frame_add_percept(struct frame_builder *v, const muster_Percept *percept)
{
    MU_ASSERT(v->frame.percepts._length < v->robot_count);
    v->frame.percepts._buffer[v->frame.percepts._length++] = *percept;
}

/* @return whether there was room for its texts and mails */
static bool act_keep(struct frame_builder *v, muster_Act *copy, const muster_Act *act)
{
    struct pool_bytes *p = &v->text;
    size_t before = p->used;
    uint32_t count = act->mails._length;
    *copy = *act;
    copy->agent = text_keep(p, act->agent);
    copy->rules = text_keep(p, act->rules);
    copy->goal = text_keep(p, act->goal);
    copy->diary = text_keep(p, act->diary);
    muster_Mail *mails = count > 0 ? bytes_take(p, count * sizeof *mails) : NULL;
    for (uint32_t i = 0; mails && i < count; i++) {
        mails[i] = mail_keep(p, &act->mails._buffer[i]);
    }
    copy->mails = (dds_sequence_muster_Mail){._maximum = count, ._length = count, ._buffer = mails};
    return bytes_settle(p, before);
}

void frame_add_act(struct frame_builder *v, size_t robot, const muster_Act *act)
{
    MU_ASSERT(robot < v->robot_count + MU_AGENTS_MAX);
    v->chains_count = robot < v->chains_count ? v->chains_count : robot + 1;
    int32_t index = (int32_t)v->act_count;
    if (v->act_count == MU_FRAME_ACTS_MAX || !act_keep(v, &v->acts[index], act)) {
        v->left_out++;
        return;
    }
    struct chain *c = &v->chains[robot];
    v->act_count++;
    v->next[index] = FRAME_NONE;
    if (c->first == FRAME_NONE) {
        c->first = index;
    } else {
        v->next[c->last] = index;
    }
    c->last = index;
}

void frame_add_outside(struct frame_builder *v, int64_t step, const muster_Mail *mails,
                       uint32_t count)
{
    struct outside *o = &v->outside[step & 1];
    if (o->step != step) {
        o->step = step;
        o->count = 0;
        o->text.used = 0;
    }
    for (uint32_t i = 0; i < count; i++) {
        size_t before = o->text.used;
        bool fits = o->count < MU_FRAME_MAILS_MAX;
        if (fits) {
            o->mails[o->count] = mail_keep(&o->text, &mails[i]);
            fits = bytes_settle(&o->text, before);
        }
        o->count += fits;
        v->left_out += !fits;
    }
}

void frame_add_order(struct frame_builder *v, const muster_RunCommand *order)
{
    if (v->order_count == MU_ORDERS_MAX) {
        v->left_out++;
        return;
    }
    order_copy(&v->orders[v->order_count++], order);
}

/* --- the Frame -------------------------------------------------------------------------------- */

muster_RobotView *frame_robot(struct frame_builder *v, size_t robot)
{
    return &v->frame.robots._buffer[robot];
}

muster_AgentView *frame_agent(struct frame_builder *v, size_t agent)
{
    return &v->frame.agents._buffer[agent];
}

static void acts_sort(struct frame_builder *v)
{
    uint32_t count = 0;
    for (size_t r = 0; r < v->chains_count; r++) {
        for (int32_t i = v->chains[r].first; i != FRAME_NONE; i = v->next[i]) {
            v->sorted[count++] = v->acts[i];
        }
    }
    v->frame.acts =
        (dds_sequence_muster_Act){._maximum = count, ._length = count, ._buffer = v->sorted};
}

static void orders_list(struct frame_builder *v)
{
    uint32_t count = v->order_count;
    for (uint32_t i = 0; i < count; i++) {
        v->orders_out[i] = v->orders[i].command;
        v->orders_out[i].simulator = v->frame.simulator;
    }
    v->frame.orders = (dds_sequence_muster_RunCommand){
        ._maximum = count, ._length = count, ._buffer = v->orders_out};
}

muster_Frame *frame_finish(struct frame_builder *v)
{
    struct outside *o = &v->outside[v->frame.step & 1];
    uint32_t count = o->step == v->frame.step ? o->count : 0;
    acts_sort(v);
    orders_list(v);
    v->frame.percepts._maximum = v->frame.percepts._length;
    v->frame.outside =
        (dds_sequence_muster_Mail){._maximum = count, ._length = count, ._buffer = o->mails};
    return &v->frame;
}

void frame_clear(struct frame_builder *v)
{
    chains_clear(v);
}

uint64_t frame_left_out(const struct frame_builder *v)
{
    return v->left_out;
}
