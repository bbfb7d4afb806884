/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/engine/ode_world.h"

#include "core/log.h"
#include "muster/memory.h"
#include "muster/result.h"

#include <ode/ode.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Measured: 1 mm of steady penetration, and no explosions in a crowd of 1000. */
static const struct {
    double friction, soft_erp, soft_cfm, correcting_m_s, layer_m;
    double deep_m;
    size_t rounds_min, rounds_max, deep_per_round;
} ode_world_tuning = {0.5, 0.2, 1e-5, 1.0, 0.001, 0.003, 20, 100, 8};

struct ode_body {
    dBodyID id;
    dJointID slide, spin; /* motors that act as the floor's friction; NULL: none */
};

static struct {
    dWorldID world;
    dJointGroupID contacts;
    struct ode_body *bodies;
    size_t count, max;
    size_t deep; /* contacts of the next step that are deeper than deep_m */
} ode_world;

static void ode_world_log(enum mu_log_level level, const char *event, int number,
                          const char *format, va_list args)
{
    char text[256];
    vsnprintf(text, sizeof text, format, args);
    mu_log(level, event, "number=%d text=\"%s\"", number, text);
}

/* ODE must not continue after an error of its own: its results would be meaningless. */
static _Noreturn void ode_world_failed(int number, const char *format, va_list args)
{
    ode_world_log(MU_LOG_ERROR, "ode-failed", number, format, args);
    abort();
}

static void ode_world_remark(int number, const char *format, va_list args)
{
    ode_world_log(MU_LOG_WARNING, "ode-message", number, format, args);
}

void ode_world_open(size_t bodies_max)
{
    MU_ASSERT(!ode_world.world);
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    dSetErrorHandler(ode_world_failed);
    dSetDebugHandler(ode_world_failed);
    dSetMessageHandler(ode_world_remark);
    ode_world.world = dWorldCreate();
    ode_world.contacts = dJointGroupCreate(0);
    dWorldSetGravity(ode_world.world, 0, 0, 0);
    dWorldSetContactMaxCorrectingVel(ode_world.world, ode_world_tuning.correcting_m_s);
    dWorldSetContactSurfaceLayer(ode_world.world, ode_world_tuning.layer_m);
    if (bodies_max > ode_world.max) { /* a later world reuses the memory if it fits */
        ode_world.bodies = mu_startup_array(bodies_max, sizeof *ode_world.bodies);
        ode_world.max = bodies_max;
    }
    ode_world.count = 0;
    ode_world.deep = 0;
}

void ode_world_close(void)
{
    dJointGroupDestroy(ode_world.contacts);
    dWorldDestroy(ode_world.world);
    dCloseODE();
    ode_world.world = NULL;
    ode_world.contacts = NULL;
    ode_world.count = 0;
}

double ode_world_add(const struct ode_body_size *size, struct world_pose pose)
{
    MU_ASSERT(ode_world.count < ode_world.max);
    dBodyID body = dBodyCreate(ode_world.world);
    dMass mass;
    if (size->disc) {
        dMassSetCylinderTotal(&mass, size->mass_kg, 3, size->length_m / 2, size->length_m);
    } else {
        dMassSetBoxTotal(&mass, size->mass_kg, size->length_m, size->width_m, size->width_m);
    }
    /* The body turns about its own point, and its mass is taken to be there (Steiner's theorem). */
    mass.I[10] +=
        size->mass_kg * (size->middle_x_m * size->middle_x_m + size->middle_y_m * size->middle_y_m);
    dBodySetMass(body, &mass);
    dBodySetGyroscopicMode(body, 0);
    ode_world.bodies[ode_world.count++] = (struct ode_body){.id = body};
    ode_world_put(ode_world.count - 1, pose.x_m, pose.y_m, pose.heading_rad);
    return mass.I[10];
}

void ode_world_put(size_t body, double x, double y, double heading_rad)
{
    dBodyID id = ode_world.bodies[body].id;
    dQuaternion turn = {cos(heading_rad / 2), 0, 0, sin(heading_rad / 2)};
    dBodySetPosition(id, x, y, 0);
    dBodySetQuaternion(id, turn);
    dBodySetLinearVel(id, 0, 0, 0);
    dBodySetAngularVel(id, 0, 0, 0);
}

void ode_world_motion(size_t body, struct ode_motion *motion)
{
    dBodyID id = ode_world.bodies[body].id;
    const dReal *place = dBodyGetPosition(id);
    const dReal *rotation = dBodyGetRotation(id); /* rows of four */
    const dReal *linear = dBodyGetLinearVel(id);
    *motion = (struct ode_motion){.x = place[0],
                                  .y = place[1],
                                  .c = rotation[0],
                                  .s = rotation[4],
                                  .vx = linear[0],
                                  .vy = linear[1],
                                  .turn = dBodyGetAngularVel(id)[2]};
}

void ode_world_state(size_t body, double state[ENGINE_STATE_DOUBLES])
{
    dBodyID id = ode_world.bodies[body].id;
    const struct {
        const dReal *from;
        size_t count;
    } parts[] = {{dBodyGetPosition(id), 3},
                 {dBodyGetQuaternion(id), 4},
                 {dBodyGetLinearVel(id), 3},
                 {dBodyGetAngularVel(id), 3}};
    size_t n = 0;
    for (size_t p = 0; p < sizeof parts / sizeof parts[0]; p++) {
        for (size_t i = 0; i < parts[p].count; i++) {
            state[n++] = parts[p].from[i];
        }
    }
}

void ode_world_set_state(size_t body, const double state[ENGINE_STATE_DOUBLES])
{
    dBodyID id = ode_world.bodies[body].id;
    dBodySetPosition(id, state[0], state[1], state[2]);
    dBodySetQuaternion(id, &state[3]);
    /*
     * ODE has normalized the quaternion again, which can change the last bit: write it as it was.
     * ODE computes the rotation from the quaternion in the same way after each step.
     */
    dReal *quaternion = (dReal *)(uintptr_t)dBodyGetQuaternion(id);
    dReal *rotation = (dReal *)(uintptr_t)dBodyGetRotation(id);
    memcpy(quaternion, &state[3], 4 * sizeof *quaternion);
    dRfromQ(rotation, quaternion);
    dBodySetLinearVel(id, state[7], state[8], state[9]);
    dBodySetAngularVel(id, state[10], state[11], state[12]);
    dBodySetForce(id, 0, 0, 0);
    dBodySetTorque(id, 0, 0, 0);
}

void ode_world_shift(size_t body, double x, double y)
{
    dBodySetPosition(ode_world.bodies[body].id, x, y, 0);
}

void ode_world_set_velocity(size_t body, double vx, double vy, double turn)
{
    dBodyID id = ode_world.bodies[body].id;
    dBodySetLinearVel(id, vx, vy, 0);
    dBodySetAngularVel(id, 0, 0, turn);
}

void ode_world_weigh(size_t body, double mass_kg, double inertia_kg_m2)
{
    dMass mass;
    dBodyGetMass(ode_world.bodies[body].id, &mass);
    mass.mass = mass_kg;
    mass.I[10] = inertia_kg_m2;
    dBodySetMass(ode_world.bodies[body].id, &mass);
}

void ode_world_sleep(size_t body, bool sleeps)
{
    dBodyID id = ode_world.bodies[body].id;
    if (sleeps) {
        dBodyDisable(id);
    } else {
        dBodyEnable(id);
    }
}

/*
 * Friction is a motor with the aim of no motion and a limited force.  The solver weighs that force
 * against others, so that a body under a weak push does not creep.
 */
void ode_world_add_friction(size_t body)
{
    struct ode_body *b = &ode_world.bodies[body];
    b->slide = dJointCreateLMotor(ode_world.world, 0);
    dJointAttach(b->slide, b->id, NULL);
    dJointSetLMotorNumAxes(b->slide, 2);
    b->spin = dJointCreateAMotor(ode_world.world, 0);
    dJointAttach(b->spin, b->id, NULL);
    dJointSetAMotorNumAxes(b->spin, 1);
    dJointSetAMotorAxis(b->spin, 0, 0, 0, 0, 1);
}

void ode_world_set_friction(size_t body, const struct ode_friction *f)
{
    struct ode_body *b = &ode_world.bodies[body];
    dJointSetLMotorAxis(b->slide, 0, 0, f->along_x, f->along_y, 0);
    dJointSetLMotorAxis(b->slide, 1, 0, -f->along_y, f->along_x, 0);
    dJointSetLMotorParam(b->slide, dParamFMax, f->along_n);
    dJointSetLMotorParam(b->slide, dParamFMax2, f->across_n);
    dJointSetAMotorParam(b->spin, dParamFMax, f->turn_nm);
}

void ode_world_push(size_t body, double fx_n, double fy_n, double torque_nm)
{
    dBodyID id = ode_world.bodies[body].id;
    dBodyAddForce(id, fx_n, fy_n, 0);
    dBodyAddTorque(id, 0, 0, torque_nm);
}

void ode_world_touch(size_t a, int b, const struct narrow_contact *contact)
{
    dBodyID first = ode_world.bodies[a].id;
    dBodyID second = b == ODE_WORLD_STANDS ? NULL : ode_world.bodies[b].id;
    for (size_t i = 0; i < contact->count; i++) {
        ode_world.deep += contact->points[i].depth > ode_world_tuning.deep_m;
        /* Friction has one direction: the other one would be vertical. */
        dContact c = {
            .surface = {.mode = dContactApprox1 | dContactSoftERP | dContactSoftCFM | dContactMu2 |
                                dContactFDir1,
                        .mu = ode_world_tuning.friction,
                        .mu2 = 0,
                        .soft_erp = ode_world_tuning.soft_erp,
                        .soft_cfm = ode_world_tuning.soft_cfm},
            .geom = {.pos = {contact->points[i].x, contact->points[i].y, 0},
                     .normal = {contact->normal_x, contact->normal_y, 0},
                     .depth = contact->points[i].depth},
            .fdir1 = {-contact->normal_y, contact->normal_x, 0},
        };
        dJointAttach(dJointCreateContact(ode_world.world, ode_world.contacts, &c), first, second);
    }
}

/* A push travels about one body per round: more bodies under pressure need more rounds. */
static int ode_world_rounds(void)
{
    size_t rounds = ode_world_tuning.rounds_min + ode_world.deep / ode_world_tuning.deep_per_round;
    size_t most = ode_world_tuning.rounds_max;
    return (int)(rounds > most ? most : rounds);
}

void ode_world_step(double dt_s, uint64_t seed)
{
    /*
     * QuickStep shuffles with a generator that the whole process shares: set its state each time.
     */
    dRandSetSeed((unsigned long)(seed & 0xffffffffu));
    dWorldSetQuickStepNumIterations(ode_world.world, ode_world_rounds());
    dWorldQuickStep(ode_world.world, dt_s);
    dJointGroupEmpty(ode_world.contacts);
    ode_world.deep = 0;
}

const char *ode_world_version(void)
{
    return dODE_VERSION;
}
