/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The benchmark's scene in Box2D, with a bare driver: rigid bodies, and one ray cast for each beam.
 *   box2d TABLE SECONDS LASER    prints CPU seconds a simulated second, and metres a second driven
 * Robots move as ours do: a force that the wheels' friction bounds, from limits of acceleration.
 */
#include "wander.h"

#include <box2d/box2d.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

namespace {

constexpr int kSubsteps = 5; /* of 20 ms in a control step of 100 ms, as ours */
constexpr double kStep = 0.02, kWall = 0.1, kDegree = M_PI / 180;

struct Robot {
    b2Body *body;
    wander mind;
    double forward = 0, turn = 0; /* what the wheels do */
    float sonar[WANDER_SONARS], laser[WANDER_BEAMS];
    bool bumped = false;
};

class Nearest : public b2RayCastCallback {
public:
    explicit Nearest(const b2Body *self) : self_(self) {}
    float ReportFixture(b2Fixture *fixture, const b2Vec2 &, const b2Vec2 &, float fraction) override
    {
        if (fixture->GetBody() == self_) {
            return -1; /* as if it were not there */
        }
        share = fraction;
        return fraction;
    }
    float share = 1;

private:
    const b2Body *self_;
};

class Bumps : public b2ContactListener {
    void BeginContact(b2Contact *contact) override
    {
        for (b2Fixture *fixture : {contact->GetFixtureA(), contact->GetFixtureB()}) {
            auto *robot = reinterpret_cast<Robot *>(fixture->GetBody()->GetUserData().pointer);
            if (robot) {
                robot->bumped = true;
            }
        }
    }
};

class Scene {
public:
    explicit Scene(const char *table) : world_(b2Vec2(0, 0))
    {
        world_.SetContactListener(&bumps_);
        robots_.reserve(4096); /* bodies point to them */
        FILE *f = fopen(table, "r");
        char line[256];
        while (f && fgets(line, sizeof line, f)) {
            add(line);
        }
        if (f) {
            fclose(f);
        }
    }

    void step(bool laser)
    {
        for (Robot &robot : robots_) {
            sense(robot, laser);
            wander_step(&robot.mind, robot.sonar, robot.bumped);
            robot.bumped = false;
        }
        for (int k = 0; k < kSubsteps; k++) {
            for (Robot &robot : robots_) {
                drive(robot);
            }
            world_.Step(kStep, 8, 3);
        }
    }

    double way() const
    {
        double sum = 0;
        for (const Robot &robot : robots_) {
            sum += robot.body->GetLinearVelocity().Length();
        }
        return robots_.empty() ? 0 : sum / static_cast<double>(robots_.size());
    }

private:
    void wall(double x, double y, double hx, double hy, double angle)
    {
        b2BodyDef def;
        def.position.Set(x, y);
        def.angle = angle;
        b2PolygonShape box;
        box.SetAsBox(hx, hy);
        world_.CreateBody(&def)->CreateFixture(&box, 0)->SetFriction(0.5f);
    }

    void disc(double x, double y, double radius)
    {
        b2BodyDef def;
        def.position.Set(x, y);
        b2CircleShape circle;
        circle.m_radius = radius;
        world_.CreateBody(&def)->CreateFixture(&circle, 0);
    }

    void robot(double x, double y, double angle)
    {
        robots_.emplace_back();
        Robot &robot = robots_.back();
        wander_start(&robot.mind, robots_.size() - 1);
        b2BodyDef def;
        def.type = b2_dynamicBody;
        def.position.Set(x, y);
        def.angle = angle;
        def.userData.pointer = reinterpret_cast<uintptr_t>(&robot);
        robot.body = world_.CreateBody(&def);
        b2PolygonShape box;
        box.SetAsBox(WANDER_LENGTH_M / 2, WANDER_WIDTH_M / 2);
        robot.body->CreateFixture(&box, WANDER_MASS_KG / (WANDER_LENGTH_M * WANDER_WIDTH_M));
    }

    void add(const char *line)
    {
        double v[5];
        if (sscanf(line, "arena,%lf", v) == 1) {
            double half = v[0] / 2 + kWall;
            wall(0, half, half + kWall, kWall, 0);
            wall(0, -half, half + kWall, kWall, 0);
            wall(half, 0, kWall, half, 0);
            wall(-half, 0, kWall, half, 0);
        } else if (sscanf(line, "box,%lf,%lf,%lf,%lf,%lf", v, v + 1, v + 2, v + 3, v + 4) == 5) {
            wall(v[0], v[1], v[2] / 2, v[3] / 2, v[4] * kDegree);
        } else if (sscanf(line, "disc,%lf,%lf,%lf", v, v + 1, v + 2) == 3) {
            disc(v[0], v[1], v[2]);
        } else if (sscanf(line, "robot,%lf,%lf,%lf", v, v + 1, v + 2) == 3) {
            robot(v[0], v[1], v[2] * kDegree);
        }
    }

    float ray(const Robot &robot, b2Vec2 from, b2Vec2 along, double range)
    {
        Nearest nearest(robot.body);
        world_.RayCast(&nearest, from, from + static_cast<float>(range) * along);
        return nearest.share * static_cast<float>(range);
    }

    void sense(Robot &robot, bool laser)
    {
        static const double ring[WANDER_SONARS][3] = {
            {0.075, 0.130, 90},     {0.115, 0.115, 50},    {0.150, 0.080, 30},
            {0.170, 0.025, 10},     {0.170, -0.025, -10},  {0.150, -0.080, -30},
            {0.115, -0.115, -50},   {0.075, -0.130, -90},  {-0.155, -0.130, -90},
            {-0.195, -0.115, -130}, {-0.230, -0.080, -150}, {-0.250, -0.025, -170},
            {-0.250, 0.025, 170},   {-0.230, 0.080, 150},  {-0.195, 0.115, 130},
            {-0.155, 0.130, 90}};
        const b2Transform &frame = robot.body->GetTransform();
        for (int i = 0; i < WANDER_SONARS; i++) {
            b2Vec2 from = b2Mul(frame, b2Vec2(ring[i][0], ring[i][1]));
            b2Vec2 along(cos(ring[i][2] * kDegree), sin(ring[i][2] * kDegree));
            robot.sonar[i] = ray(robot, from, b2Mul(frame.q, along), WANDER_SONAR_M);
        }
        for (int i = 0; laser && i < WANDER_BEAMS; i++) {
            double angle = -M_PI / 2 + M_PI * i / (WANDER_BEAMS - 1);
            b2Vec2 along(cos(angle), sin(angle));
            robot.laser[i] = ray(robot, frame.p, b2Mul(frame.q, along), WANDER_LASER_M);
        }
    }

    static double toward(double now, double aim, double most)
    {
        return now + std::clamp(aim - now, -most, most);
    }

    static void drive(Robot &robot)
    {
        b2Body *body = robot.body;
        robot.forward = toward(robot.forward, robot.mind.forward_m_s, WANDER_ACCEL_M_S2 * kStep);
        robot.turn = toward(robot.turn, robot.mind.turn_rad_s, WANDER_TURN_ACCEL * kStep);
        double most = WANDER_FRICTION * WANDER_MASS_KG * 9.81;
        b2Vec2 own = body->GetLocalVector(body->GetLinearVelocity());
        double forward = WANDER_MASS_KG * (robot.forward - own.x) / kStep;
        double left = -WANDER_MASS_KG * own.y / kStep;
        double turn = body->GetInertia() * (robot.turn - body->GetAngularVelocity()) / kStep;
        b2Vec2 force(std::clamp(forward, -most, most), std::clamp(left, -most, most));
        body->ApplyForceToCenter(body->GetWorldVector(force), true);
        body->ApplyTorque(std::clamp(turn, -0.15 * most, 0.15 * most), true);
    }

    Bumps bumps_;
    b2World world_;
    std::vector<Robot> robots_;
};

double cpu_s()
{
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

} // namespace

int main(int argc, char **argv)
{
    if (argc != 4) {
        fprintf(stderr, "usage: box2d TABLE SECONDS LASER\n");
        return 2;
    }
    Scene scene(argv[1]);
    int steps = static_cast<int>(10 * strtod(argv[2], nullptr));
    bool laser = argv[3][0] == '1';
    double way = 0, began = cpu_s();
    for (int k = 0; k < steps; k++) {
        scene.step(laser);
        way += scene.way() / steps;
    }
    printf("%.9g %.4f\n", (cpu_s() - began) / (steps * 0.1), way);
    return 0;
}
