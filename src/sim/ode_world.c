/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/ode_world.h"

#include "muster/memory.h"
#include "muster/result.h"

#include <math.h>
#include <ode/ode.h>
#include <stdio.h>
#include <stdlib.h>

/* Measured: 1 mm of steady penetration, no explosions in a crowd of 1000. */
static const struct {
    double friction, soft_erp, soft_cfm, correcting_m_s, layer_m;
    int iterations;
} ode_world_tuning = {0.5, 0.2, 1e-5, 1.0, 0.001, 20};

static struct {
    dWorldID world;
    dJointGroupID contacts;
    dBodyID *bodies;
    size_t count, max;
} ode_world;

/* ODE must not go on after its own errors: what it would compute then is no simulation. */
static _Noreturn void ode_world_failed(int number, const char *format, va_list args)
{
    fprintf(stderr, "ODE error %d: ", number);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    abort();
}

static void ode_world_remark(int number, const char *format, va_list args)
{
    fprintf(stderr, "ODE message %d: ", number);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
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
    dWorldSetQuickStepNumIterations(ode_world.world, ode_world_tuning.iterations);
    dWorldSetContactMaxCorrectingVel(ode_world.world, ode_world_tuning.correcting_m_s);
    dWorldSetContactSurfaceLayer(ode_world.world, ode_world_tuning.layer_m);
    if (bodies_max > ode_world.max) { /* a later world uses the same memory if it can */
        ode_world.bodies = mu_startup_array(bodies_max, sizeof(dBodyID));
        ode_world.max = bodies_max;
    }
    ode_world.count = 0;
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
    dMassSetBoxTotal(&mass, size->mass_kg, size->length_m, size->width_m, size->width_m);
    /* The body turns about its own point; the weight is taken to lie there (Steiner's theorem). */
    mass.I[10] +=
        size->mass_kg * (size->middle_x_m * size->middle_x_m + size->middle_y_m * size->middle_y_m);
    dBodySetMass(body, &mass);
    dBodySetGyroscopicMode(body, 0);
    ode_world.bodies[ode_world.count++] = body;
    ode_world_put(ode_world.count - 1, pose.x_m, pose.y_m, pose.heading_rad);
    return mass.I[10];
}

void ode_world_put(size_t body, double x, double y, double heading_rad)
{
    dBodyID id = ode_world.bodies[body];
    dQuaternion turn = {cos(heading_rad / 2), 0, 0, sin(heading_rad / 2)};
    dBodySetPosition(id, x, y, 0);
    dBodySetQuaternion(id, turn);
    dBodySetLinearVel(id, 0, 0, 0);
    dBodySetAngularVel(id, 0, 0, 0);
}

void ode_world_motion(size_t body, struct ode_motion *motion)
{
    dBodyID id = ode_world.bodies[body];
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

void ode_world_state(size_t body, double state[ODE_WORLD_STATE])
{
    dBodyID id = ode_world.bodies[body];
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

void ode_world_push(size_t body, double fx_n, double fy_n, double torque_nm)
{
    dBodyID id = ode_world.bodies[body];
    dBodyAddForce(id, fx_n, fy_n, 0);
    dBodyAddTorque(id, 0, 0, torque_nm);
}

void ode_world_touch(size_t a, int b, const struct narrow_contact *contact)
{
    dBodyID first = ode_world.bodies[a];
    dBodyID second = b == ODE_WORLD_STANDS ? NULL : ode_world.bodies[b];
    for (size_t i = 0; i < contact->count; i++) {
        /* One direction of friction: the other one would be vertical. */
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

void ode_world_step(double dt_s, uint64_t seed)
{
    /* QuickStep shuffles with one generator for the whole process: its state is set, not kept. */
    dRandSetSeed((unsigned long)(seed & 0xffffffffu));
    dWorldQuickStep(ode_world.world, dt_s);
    dJointGroupEmpty(ode_world.contacts);
}
