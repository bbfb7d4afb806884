/* SPDX-License-Identifier: Apache-2.0 */
#include "muster/memory.h"
#include "runtime/letter.h"
#include "runtime/watch.h"

/* The border bounds what a sample holds; here it is bounded once more. */
struct watch_room {
    struct mu_scene scene;
    struct mu_frame frame;
    struct mu_outline walls[MU_WATCH_WALLS_MAX];
    struct mu_figure robots[MU_ROBOTS_MAX], objects[MU_OBJECTS_MAX];
    struct mu_robot_view robot_views[MU_ROBOTS_MAX];
    struct mu_object_view object_views[MU_OBJECTS_MAX];
    struct mu_agent_view agent_views[MU_AGENTS_MAX];
    struct mu_act_view acts[MU_FRAME_ACTS_MAX];
    struct mu_mail mails[MU_WATCH_MAILS_MAX];
    size_t mail_count;
};

struct watch_room *watch_room_take(void)
{
    return mu_startup_alloc(sizeof(struct watch_room));
}

static size_t at_most(size_t count, size_t most)
{
    return count < most ? count : most;
}

/* --- Scene ------------------------------------------------------------------------------------ */

static struct mu_outline outline_of(const muster_Outline *o)
{
    return (struct mu_outline){.rgb = o->rgb,
                               .flat = o->flat,
                               .radius_m = o->radius_m,
                               .corner_count = o->corners_m._length / 2,
                               .corners_m = o->corners_m._buffer};
}

/* They are the sample's own: both structs are one. */
static const struct mu_mount *mounts_of(const dds_sequence_muster_Mount *mounts)
{
    _Static_assert(sizeof(struct mu_mount) == sizeof(muster_Mount) &&
                       offsetof(struct mu_mount, y_m) == offsetof(muster_Mount, y_m) &&
                       offsetof(struct mu_mount, heading_rad) ==
                           offsetof(muster_Mount, heading_rad) &&
                       offsetof(struct mu_mount, fov_rad) == offsetof(muster_Mount, fov_rad) &&
                       offsetof(struct mu_mount, range_m) == offsetof(muster_Mount, range_m) &&
                       offsetof(struct mu_mount, beams) == offsetof(muster_Mount, beams),
                   "a mount in C is one on the wire");
    const void *first = mounts->_length > 0 ? mounts->_buffer : NULL;
    return first;
}

static size_t figures_of(struct mu_figure *to, const muster_Figure *from, size_t count, size_t most)
{
    count = at_most(count, most);
    for (size_t i = 0; i < count; i++) {
        const muster_Figure *f = &from[i];
        to[i] = (struct mu_figure){.name = f->name,
                                   .color = f->color,
                                   .shape = outline_of(&f->shape),
                                   .x_m = f->x_m,
                                   .y_m = f->y_m,
                                   .heading_rad = f->heading_rad,
                                   .controlled = f->controlled,
                                   .sonar_count = f->sonars._length,
                                   .sonars = mounts_of(&f->sonars),
                                   .laser = mounts_of(&f->lasers),
                                   .camera = mounts_of(&f->cameras),
                                   .fiducial_finder = mounts_of(&f->fiducial_finders)};
    }
    return count;
}

const struct mu_scene *watch_scene(struct watch_room *r, const muster_Scene *s)
{
    size_t walls = at_most(s->walls._length, MU_WATCH_WALLS_MAX);
    for (size_t i = 0; i < walls; i++) {
        r->walls[i] = outline_of(&s->walls._buffer[i]);
    }
    size_t robots = figures_of(r->robots, s->robots._buffer, s->robots._length, MU_ROBOTS_MAX);
    size_t objects = figures_of(r->objects, s->objects._buffer, s->objects._length, MU_OBJECTS_MAX);
    r->scene = (struct mu_scene){.simulator = s->simulator,
                                 .world = s->world,
                                 .seed = s->seed,
                                 .step_ns = s->step_ns,
                                 .min_x_m = s->min_x_m,
                                 .min_y_m = s->min_y_m,
                                 .max_x_m = s->max_x_m,
                                 .max_y_m = s->max_y_m,
                                 .wall_count = walls,
                                 .robot_count = robots,
                                 .object_count = objects,
                                 .walls = r->walls,
                                 .robots = r->robots,
                                 .objects = r->objects};
    return &r->scene;
}

/* --- Frame ------------------------------------------------------------------------------------ */

static enum mu_state state_of(muster_State state)
{
    return (unsigned)state < muster_STATE_ABSENT ? (enum mu_state)state : MU_GONE;
}

static void robots_fill(struct watch_room *r, const muster_Frame *f)
{
    r->frame.robot_count = at_most(f->robots._length, MU_ROBOTS_MAX);
    r->frame.robots = r->robot_views;
    for (size_t i = 0; i < r->frame.robot_count; i++) {
        const muster_RobotView *v = &f->robots._buffer[i];
        r->robot_views[i] = (struct mu_robot_view){.name = v->name,
                                                   .state = state_of(v->state),
                                                   .x_m = v->x_m,
                                                   .y_m = v->y_m,
                                                   .heading_rad = v->heading_rad,
                                                   .forward_m_s = v->forward_m_s,
                                                   .turn_rad_s = v->turn_rad_s,
                                                   .command_forward_m_s = v->command_forward_m_s,
                                                   .command_turn_rad_s = v->command_turn_rad_s,
                                                   .goal = v->goal,
                                                   .stalled = v->stalled,
                                                   .fault = v->fault,
                                                   .placed = v->placed,
                                                   .distance_m = v->distance_m,
                                                   .stalled_s = v->stalled_s,
                                                   .stalls = v->stalls,
                                                   .firings = v->firings,
                                                   .mails_sent = v->mails_sent,
                                                   .mails_received = v->mails_received};
    }
}

static void objects_fill(struct watch_room *r, const muster_Frame *f)
{
    r->frame.object_count = at_most(f->objects._length, MU_OBJECTS_MAX);
    r->frame.objects = r->object_views;
    for (size_t i = 0; i < r->frame.object_count; i++) {
        const muster_ObjectPlace *o = &f->objects._buffer[i];
        r->object_views[i] = (struct mu_object_view){o->name, o->x_m, o->y_m, o->heading_rad};
    }
}

static void agents_fill(struct watch_room *r, const muster_Frame *f)
{
    r->frame.agent_count = at_most(f->agents._length, MU_AGENTS_MAX);
    r->frame.agents = r->agent_views;
    for (size_t i = 0; i < r->frame.agent_count; i++) {
        const muster_AgentView *v = &f->agents._buffer[i];
        r->agent_views[i] = (struct mu_agent_view){v->name, state_of(v->state), v->firings,
                                                   v->mails_sent, v->mails_received};
    }
}

/* @return the first of them; those without room are counted */
static const struct mu_mail *mails_fill(struct watch_room *r, const muster_Mail *mails,
                                        size_t length, size_t *count)
{
    struct mu_mail *first = r->mails + r->mail_count;
    *count = at_most(length, MU_WATCH_MAILS_MAX - r->mail_count);
    for (size_t i = 0; i < *count; i++) {
        first[i] = letter_of(&mails[i]);
    }
    r->mail_count += *count;
    r->frame.cut += length - *count;
    return first;
}

static void acts_fill(struct watch_room *r, const muster_Frame *f)
{
    r->frame.act_count = at_most(f->acts._length, MU_FRAME_ACTS_MAX);
    r->frame.acts = r->acts;
    for (size_t i = 0; i < r->frame.act_count; i++) {
        const muster_Act *a = &f->acts._buffer[i];
        struct mu_act_view *v = &r->acts[i];
        *v = (struct mu_act_view){.agent = a->agent,
                                  .state = state_of(a->state),
                                  .firings = a->firings,
                                  .rules = a->rules,
                                  .diary = a->diary};
        v->mails = mails_fill(r, a->mails._buffer, a->mails._length, &v->mail_count);
    }
}

struct mu_frame *watch_frame(struct watch_room *r, const muster_Frame *f)
{
    r->frame = (struct mu_frame){
        .step = f->step, .time_ns = f->time_ns, .wall_ns = f->wall_ns, .digest = f->digest};
    r->mail_count = 0;
    robots_fill(r, f);
    objects_fill(r, f);
    agents_fill(r, f);
    acts_fill(r, f);
    r->frame.outside =
        mails_fill(r, f->outside._buffer, f->outside._length, &r->frame.outside_count);
    return &r->frame;
}
