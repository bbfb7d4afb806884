/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file engine_core.h
 * The state of the engine, and the functions that its files share.
 *
 * A *body* is moved by ODE: first the robots, then the objects.  A *part* is a solid that belongs
 * to a body: first the robots' cases, then the paddles of their grippers, then the objects.  A held
 * object belongs to the body of the robot that holds it.
 */
#ifndef MUSTER_SIM_ENGINE_CORE_H
#define MUSTER_SIM_ENGINE_CORE_H

#include "sim/devices/devices.h"
#include "sim/engine/engine.h"
#include "sim/engine/ode_world.h"

/* --- bounds ----------------------------------------------------------------------------------- */

/* The region that bodies of a world can reach. */
struct bounds {
    double min_x, min_y, max_x, max_y;
    bool closed; /* standing solids enclose it */
};

/**
 * Measures the bounds: the box around all standing solids that stop bodies, if they close each side
 * but for gaps of gap_m.  Otherwise the bounds are so wide that only a fault of the physics takes a
 * body there.
 */
void bounds_measure(struct bounds *bounds, const struct solid *still, size_t count, double gap_m);

/** Widens the bounds if a body starts outside. */
void bounds_include(struct bounds *bounds, double x, double y);

/** @return whether a position is finite and inside the bounds */
bool bounds_holds(const struct bounds *bounds, double x, double y);

/* --- the engine ------------------------------------------------------------------------------- */

enum { ENGINE_NO_BEARER = -1 };

struct engine_body {
    const char *name;
    struct ode_motion motion;      /* now */
    struct ode_motion last_good;   /* after the last control step */
    double middle_x_m, middle_y_m; /* middle of the outline, in the body's frame */
    double mass_kg, inertia_kg_m2; /* without load */
    double speed_max_m_s;          /* a faster body could jump over something */
    struct engine_force push;      /* from outside */
    uint32_t push_substeps;        /* remaining time of the push */
    bool asleep;                   /* an object at rest, without a push */
    bool shifted;                  /* moved apart from another body in this substep */
    bool touched;                  /* a moving body touches it in this substep */
    bool placed;                   /* put somewhere since it was last sensed */
    bool fault;                    /* reset in this step */
    uint64_t faults;               /* number of resets */
};

struct engine_robot {
    struct drive drive;
    struct odometer odometer;
    struct gps gps;
    struct battery battery;
    struct gripper gripper;
    size_t paddles;     /* the first of its two parts, if there is a gripper */
    double drive_w;     /* mechanical power of the wheels in this substep */
    double charge_w;    /* power that a charger at its side offers */
    uint32_t bumpers;   /* sectors touched in this step */
    uint32_t grip_felt; /* bits of enum mu_gripper */
};

struct engine_object {
    double friction_n, friction_nm; /* the most that the floor exerts */
    int32_t bearer;                 /* the robot that holds it */
    double x, y, c, s;              /* its pose in the frame of the bearer */
    bool claimed; /* a gripper of the snapshot holds it, while the snapshot is checked */
};

struct engine_part {
    int32_t body; /* ODE_WORLD_STANDS: none, the part stands */
    bool is_case; /* the case of a robot: it has a bumper and contacts for charging */
    const struct world_look *look;
};

/* Two solids that may touch: a part, and another part or a standing shape. */
struct engine_pair {
    uint32_t part, other;
    bool stands;
};

/* The pose of a part when it was marked. */
struct neighbours_mark {
    struct frame place;
    bool away;
};

/* The pairs of a part: `count` of them, from `first` on. */
struct neighbours_list {
    size_t first, count;
    bool is_there;
};

/*
 * Neighbour lists with a margin.  They are valid until a part has moved half of the margin since it
 * was marked.
 */
struct neighbours {
    struct engine_pair *pairs; /* for each part: standing shapes, then parts, each by number */
    size_t pairs_used, pairs_max;
    struct neighbours_list *lists; /* one per part */
    struct neighbours_mark *marks; /* one per part */
    double margin_m;               /* of new lists */
    struct engine_pair *found;     /* of one part; room for all */
    bool is_new;                   /* nothing is marked yet */
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
    struct solid *outlines; /* of all parts, at their present poses */
    struct engine_part *parts;
    struct solid *shapes; /* standing shapes */
    struct engine_part *stands;
    struct engine_pair *pairs; /* pairs that are near each other in this substep */
    size_t pair_count, pairs_max;
    size_t awake_end; /* all objects from this part on are asleep */
    struct bounds bounds;
    struct grid grid;
    bool grid_is_old; /* a part has moved since the grid was built */
    struct neighbours neighbours;
    struct grid_near near;
    struct sensors *sensors;
    struct engine_sample *samples; /* of the last engine_sense_all */
    char reason[160];              /* of the last refusal */
};

/* bodies.c: */

/** Adds the bodies of all robots, then of all objects. */
void bodies_add(struct engine *e);

/** Sets the devices of a robot to their state at the start. */
void bodies_start_devices(struct engine *e, size_t robot);

/** Copies the pose of a body from ODE, and moves its own part.  Its load stays. */
void bodies_follow(struct engine *e, size_t body);

/** @return the part of an object */
size_t bodies_object_part(const struct engine *e, size_t object);

/** @return the frame of a body */
struct frame bodies_frame(const struct engine *e, size_t body);

/** @return whether a robot holds this body */
bool bodies_is_held(const struct engine *e, size_t body);

/* space.c: */

/** Updates the grid if a part has moved.  Call it before each query of the grid. */
void space_refresh(struct engine *e);

/**
 * Finds an obstacle for a solid that belongs to a body.
 *
 * @param tolerance_m  depth of overlap that is allowed
 * @return the name of the obstacle; NULL: there is room
 */
const char *space_obstacle(struct engine *e, const struct solid *solid, size_t body,
                           double tolerance_m);

/* neighbours.c: */

/** Takes memory for the lists. */
void neighbours_start(struct engine *e);

/** Drops the lists if a part has moved too far.  Call it before each round of neighbours_of. */
void neighbours_watch(struct engine *e);

/**
 * Lists at least all pairs of a part for which neighbours_are_near holds.
 *
 * @param count  out: how many; they are valid until the next call
 */
const struct engine_pair *neighbours_of(struct engine *e, uint32_t part, size_t *count);

/**
 * @return whether a part is so near to another solid that they may touch, or overlap deeply after a
 *         substep
 */
bool neighbours_are_near(const struct engine *e, size_t part, const struct solid *other);

/* grip.c: */

/** Moves a gripper for one substep.  @return whether it moved */
bool grip_run(struct engine *e, size_t robot);

/** Moves the paddles and the load of a robot to their poses. */
void grip_carry(struct engine *e, size_t robot);

/** Releases the object that a robot holds, where it is. */
void grip_let_go(struct engine *e, size_t robot);

/** Takes the object that a robot has just released; neither has moved since. */
void grip_take_back(struct engine *e, size_t robot, size_t object);

/** Restores the load of a robot from its gripper, after a snapshot was read. */
void grip_resume(struct engine *e, size_t robot);

/** Computes the readings of all grippers. */
void grip_feel_all(struct engine *e);

/* motion.c: */

/** Copies the pose of a body from ODE, and moves all its parts. */
void motion_follow(struct engine *e, size_t body);

/** Puts a body at a pose, at rest. */
void motion_put(struct engine *e, size_t body, struct world_pose pose);

/** Updates all bodies after a substep. */
void motion_settle(struct engine *e);

/** Sets the friction on an object for the next substep. */
void motion_set_friction(struct engine *e, size_t object);

/** Applies pushes from outside, and the friction on all objects. */
void motion_load_forces(struct engine *e);

/* contacts.c: */

/** Finds all contacts of this substep, in a fixed order. */
void contacts_find(struct engine *e);

/* separate.c: */

/** Separates the near pairs of this substep that overlap deeply. */
void separate_all(struct engine *e);

/* percept.c: */

/** Fills in all readings of a robot but the lists of its sensors.  Changes no state. */
void percept_read(const struct engine *e, size_t robot, struct engine_sample *out);

/* sanity.c: */

/**
 * Resets each body with a state that is not finite, or outside the bounds, to its last good pose.
 */
void sanity_check(struct engine *e);

/* --- blocks ----------------------------------------------------------------------------------- */

/*
 * A block of numbers with the same bytes on all machines: 8 bytes each, lowest first.
 *
 * One walk over a state writes, checks or reads it, by the mode of the block: so both formats
 * agree.
 */

enum block_mode {
    BLOCK_MEASURE, /* only counts and sums up */
    BLOCK_WRITE,
    BLOCK_CHECK, /* verifies without change */
    BLOCK_READ
};

struct block {
    enum block_mode mode;
    unsigned char *bytes;
    size_t room, used;
    uint64_t sum; /* FNV-1a of all bytes so far */
    bool bad;     /* a number was missing or out of range */
};

struct block block_open(enum block_mode mode, unsigned char *bytes, size_t room);

/** Passes a number.  @return the number, at most `most` */
uint64_t block_number(struct block *block, uint64_t *value, uint64_t most);

/** Passes a finite number from lo to hi. */
void block_double(struct block *block, double *value, double lo, double hi);

void block_flag(struct block *block, bool *value);

/** Passes an index below count, or -1.  @return the index */
int32_t block_index(struct block *block, int32_t *value, size_t count);

#endif
