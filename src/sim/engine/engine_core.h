/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file engine_core.h
 * What the files of the engine share, and nobody else sees.
 *
 * A *body* is what ODE moves: the robots, then the objects.  A *part* is a piece of matter that
 * belongs to a body: the robots' cases, then their grippers' paddles, then the objects.  An object
 * that is held belongs to the body of its bearer.
 */
#ifndef MUSTER_SIM_ENGINE_CORE_H
#define MUSTER_SIM_ENGINE_CORE_H

#include "sim/devices/devices.h"
#include "sim/engine/engine.h"
#include "sim/engine/ode_world.h"

/* --- bounds ----------------------------------------------------------------------------------- */

/*
 * How far a body of a world can get.
 */

struct bounds {
    double min_x, min_y, max_x, max_y;
    bool closed; /* what stands leaves no way out */
};

/**
 * Measures it: the box around what stands and stops bodies, if that closes each side but for gaps
 * of gap_m, else so far out that only what was flung gets there.
 */
void bounds_measure(struct bounds *bounds, const struct solid *still, size_t count, double gap_m);

/** Opens it if a place where something starts lies outside. */
void bounds_include(struct bounds *bounds, double x, double y);

/** @return whether a place is finite and inside */
bool bounds_holds(const struct bounds *bounds, double x, double y);

/* --- the engine ------------------------------------------------------------------------------- */

enum { ENGINE_NO_BEARER = -1 };

struct engine_body {
    const char *name;
    struct ode_motion motion;      /* as of now */
    struct ode_motion last_good;   /* as of the last control step */
    double middle_x_m, middle_y_m; /* of its outline, in its own frame */
    double mass_kg, inertia_kg_m2; /* without what it carries */
    double speed_max_m_s;          /* faster, it could step over something */
    struct engine_force push;      /* from outside */
    uint32_t push_substeps;        /* for so long */
    bool asleep;                   /* an object at rest that nothing pushes */
    bool shifted;                  /* it was moved apart from another one */
    bool touched;                  /* something that moves touches it in this substep */
    bool placed;                   /* it was put somewhere since it was sensed */
    bool fault;                    /* it was put back in this step */
    uint64_t faults;               /* since the start */
};

struct engine_robot {
    struct drive drive;
    struct odometer odometer;
    struct gps gps;
    struct battery battery;
    struct gripper gripper;
    size_t paddles;     /* the first of its two parts, if it has a gripper */
    double drive_w;     /* what its wheels did in this substep */
    double charge_w;    /* what stands at its side */
    uint32_t bumpers;   /* what was touched in this step */
    uint32_t grip_felt; /* bits of enum engine_gripper */
};

struct engine_object {
    double friction_n, friction_nm; /* that the floor can bring against it */
    int32_t bearer;                 /* the robot that holds it */
    double x, y, c, s;              /* its pose in the bearer's frame */
    bool claimed;                   /* by a gripper of the snapshot that is read */
};

struct engine_part {
    int32_t body; /* ODE_WORLD_STANDS: it stands */
    bool is_case; /* a robot's: it has a bumper, and plugs */
    const struct world_look *look;
};

/* Two pieces of matter that may touch: a part, and another one or a shape that stands. */
struct engine_pair {
    uint32_t part, other;
    bool stands;
};

/* Where a part was. */
struct neighbours_mark {
    struct frame place;
    bool away;
};

/* The pairs of a part that may come near it: count of them from first on. */
struct neighbours_list {
    size_t first, count;
    bool is_there;
};

/*
 * Who may come near whom soon.  Listed seldom, with a margin: the lists serve until something has
 * moved half of it since it was marked.
 */
struct neighbours {
    struct engine_pair *pairs; /* of a part, what stands comes first, and all by their numbers */
    size_t pairs_used, pairs_max;
    struct neighbours_list *lists; /* of each part */
    struct neighbours_mark *marks; /* where each part was */
    double margin_m;               /* of what is listed now */
    struct engine_pair *found;     /* of one part; room for all */
    bool is_new;                   /* nothing was marked yet */
};

struct engine {
    const struct world *world;
    uint64_t seed, steps, substeps; /* since the start */
    unsigned substeps_per_step;
    double dt_s;
    size_t robot_count, object_count, body_count, part_count, paddle_count;
    struct engine_body *bodies;
    struct engine_robot *robots;
    struct engine_object *objects;
    struct solid *outlines; /* of the parts, where they are now */
    struct engine_part *parts;
    struct solid *shapes; /* what stands */
    struct engine_part *stands;
    struct engine_pair *pairs; /* that are near each other in this substep */
    size_t pair_count, pairs_max;
    size_t awake_end; /* no object from this part on is awake */
    struct bounds bounds;
    struct grid grid;
    bool grid_is_old; /* something has moved since it was built */
    struct neighbours neighbours;
    struct grid_near near;
    struct sensors *sensors;
    struct engine_percept *percepts; /* of engine_sense_all */
    char reason[160];                /* of the last refusal */
};

/* bodies.c: */

/** Adds the bodies of all robots and objects, in that order. */
void bodies_add(struct engine *e);

/** Starts a robot's devices as the file has them. */
void bodies_start_devices(struct engine *e, size_t robot);

/** Takes over where a body is now, and moves its own part there; what it carries stays. */
void bodies_follow(struct engine *e, size_t body);

/** @return the number of an object's part */
size_t bodies_object_part(const struct engine *e, size_t object);

/** @return where a body is in the plane, as its own frame */
struct frame bodies_frame(const struct engine *e, size_t body);

/** @return whether a body is a thing that a robot holds */
bool bodies_is_held(const struct engine *e, size_t body);

/* space.c: */

/** Lays the grid anew if something has moved: before each look at it. */
void space_refresh(struct engine *e);

/**
 * Looks for what would stop a solid that belongs to a body.
 *
 * @param tolerance_m  so deep it may lie in something
 * @return NULL: there is room; else the name of what is in the way
 */
const char *space_obstacle(struct engine *e, const struct solid *solid, size_t body,
                           double tolerance_m);

/* neighbours.c: */

/** Takes memory for the lists. */
void neighbours_start(struct engine *e);

/** Drops the lists if somebody has moved too far: before each round of neighbours_of. */
void neighbours_watch(struct engine *e);

/**
 * Finds what is near a part now, or may be: all pairs that neighbours_are_near, and some more.
 *
 * @param count  out: how many; they serve until the next call
 */
const struct engine_pair *neighbours_of(struct engine *e, uint32_t part, size_t *count);

/** @return whether a part is so near another solid that they may touch, or be deep in one another
 *          after a substep */
bool neighbours_are_near(const struct engine *e, size_t part, const struct solid *other);

/* grip.c: */

/** Moves a robot's gripper for one substep.  @return whether anything moved */
bool grip_run(struct engine *e, size_t robot);

/** Moves the paddles and what is held to where the robot is. */
void grip_carry(struct engine *e, size_t robot);

/** Lets go what a robot holds, where it is. */
void grip_let_go(struct engine *e, size_t robot);

/** Takes again what a robot has just let go; neither has moved since. */
void grip_take_back(struct engine *e, size_t robot, size_t object);

/** Takes over, from a snapshot, what a robot's gripper holds. */
void grip_resume(struct engine *e, size_t robot);

/** Looks what the grippers feel, for the percepts. */
void grip_feel_all(struct engine *e);

/* motion.c: */

/** Takes over where a body is now, and moves all its parts there. */
void motion_follow(struct engine *e, size_t body);

/** Puts a body somewhere, at rest. */
void motion_put(struct engine *e, size_t body, struct world_pose pose);

/** Takes over where the bodies are after a substep. */
void motion_settle(struct engine *e);

/** Lets the floor rub on an object in the next substep. */
void motion_set_friction(struct engine *e, size_t object);

/** Pushes what is pushed from outside, and lets the floor rub on the objects. */
void motion_load_forces(struct engine *e);

/* contacts.c: */

/** Finds all contacts of this substep, in a fixed order. */
void contacts_find(struct engine *e);

/* separate.c: */

/** Moves the pairs that were noted apart, after the solver's step. */
void separate_all(struct engine *e);

/* percept.c: */

/** Fills in what a robot knows of itself: all but what it sees.  Changes nothing. */
void engine_feel(const struct engine *e, size_t robot, struct engine_percept *out);

/* sanity.c: */

/** Puts each body that left the numbers or the world back to where it was, at rest. */
void sanity_check(struct engine *e);

/* --- blocks ----------------------------------------------------------------------------------- */

/*
 * A block of numbers that is the same on every machine: 8 bytes each, the lowest first.
 *
 * One walk over a state writes it, checks it, or reads it, by the block's mode; so what is written
 * and what is read cannot differ.
 */

enum block_mode {
    BLOCK_MEASURE, /* count and sum up only */
    BLOCK_WRITE,
    BLOCK_CHECK, /* look at what is there; change nothing */
    BLOCK_READ
};

struct block {
    enum block_mode mode;
    unsigned char *bytes;
    size_t room, used;
    uint64_t sum; /* FNV-1a of all bytes so far */
    bool bad;     /* a number was missing, or not what it may be */
};

struct block block_open(enum block_mode mode, unsigned char *bytes, size_t room);

/** @return the number, which is at most `most` */
uint64_t block_number(struct block *block, uint64_t *value, uint64_t most);

/** A finite number from lo to hi. */
void block_double(struct block *block, double *value, double lo, double hi);

void block_flag(struct block *block, bool *value);

/** @return an index below count, or -1 */
int32_t block_index(struct block *block, int32_t *value, size_t count);

#endif
