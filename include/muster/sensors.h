/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file sensors.h
 * The one table of what a body senses.
 *
 * The percept in C, the border of the wire, facts and functions of rules, snapshots, the page, the
 * rows of run.csv, the words of commands and docs/reference/sensors.md are made of it.  A row adds
 * at its end: the order of rows is the order of bits and of facts.
 */
#ifndef MUSTER_SENSORS_H
#define MUSTER_SENSORS_H

#include "muster/limits.h"

/* Units in rules: MM, millimetres; DEG, degrees; HEADING, degrees in (-180, 180]; COLOR, a name or
 * #rrggbb; AS_IS, the number itself; BLOB and FIDUCIAL, the fields of such a record. */

/* clang-format off */

/* Sensors that are read only if an agent asks for them: X(SENSOR, word, text).  The word is that of
 * commands and experiments. */
#define MU_SENSORS(X) \
    X(SONAR, "sonar", "a ring of sonars") \
    X(LASER, "laser", "a scanner with one beam a sample") \
    X(CAMERA, "camera", "a camera that finds blobs of colour") \
    X(FIDUCIALS, "fiducials", "a finder of the numbers that things bear") \
    X(LASER_INTENSITY, "laser-intensity", "a part of the laser: how well each beam comes back")

/* Numbers that every body has: X(type, member, unit in rules, column of run.csv, text). */
#define MU_READINGS(X) \
    X(double, x_m, MM, "x_m", "where it takes itself to be, by its GPS or its odometer") \
    X(double, y_m, MM, "y_m", "") \
    X(double, heading_rad, HEADING, "heading_rad", "") \
    X(double, forward_m_s, MM, "forward_m_s", "as it really moves") \
    X(double, turn_rad_s, DEG, "turn_rad_s", "") \
    X(bool, stalled, AS_IS, "stalled", "its wheels have been held up for 0.3 s") \
    X(bool, fault, AS_IS, "", "the simulator had to put it back to where it was") \
    X(double, gps_x_m, MM, "", "with noise and drift") \
    X(double, gps_y_m, MM, "", "") \
    X(double, compass_rad, HEADING, "", "with noise") \
    X(double, odometer_x_m, MM, "", "as its wheels have it") \
    X(double, odometer_y_m, MM, "", "") \
    X(double, odometer_heading_rad, HEADING, "", "") \
    X(uint32_t, bumpers, AS_IS, "", \
      "bit k: touched between (2k-1) and (2k+1) eighths of pi from ahead") \
    X(uint32_t, gripper, AS_IS, "", "enum mu_gripper; 0: it has none") \
    X(double, battery_share, AS_IS, "", "of full; < 0: it has none")

/* Lists that sensors read: X(NAME, sensors that must all be asked for, element, member, its count,
 * most, unit in rules, fact, text).  A list of floats is one fact, and one list on the page; of
 * records, each is a fact. */
#define MU_CHANNELS(X) \
    X(SONAR, MU_SENSE_SONAR, float, sonar_m, sonar_count, MU_SONARS_MAX, MM, "sonar", \
      "ranges of the ring, as the world file has them") \
    X(LASER, MU_SENSE_LASER, float, laser_m, laser_count, MU_BEAMS_MAX, MM, "laser", \
      "ranges of the scanner, from right to left") \
    X(BLOBS, MU_SENSE_CAMERA, struct mu_blob, blobs, blob_count, MU_BLOBS_MAX, BLOB, "blob", \
      "nearest first") \
    X(FIDUCIALS, MU_SENSE_FIDUCIALS, struct mu_fiducial, fiducials, fiducial_count, \
      MU_FIDUCIALS_MAX, FIDUCIAL, "fiducial", "nearest first") \
    X(LASER_INTENSITY, MU_SENSE_LASER | MU_SENSE_LASER_INTENSITY, float, laser_intensity, \
      laser_intensity_count, MU_BEAMS_MAX, AS_IS, "laser-intensity", \
      "reflectance of what each beam meets, from right to left; 0: it meets nothing")

/* Fields of the records: X(type, member, unit in rules, text).  Angles are from the middle of the
 * picture. */
#define MU_BLOB(X) \
    X(uint32_t, rgb, COLOR, "0xRRGGBB") \
    X(double, bearing_rad, DEG, "") \
    X(double, width_rad, DEG, "") \
    X(double, range_m, MM, "")

#define MU_FIDUCIAL(X) \
    X(int32_t, number, AS_IS, "0: too far to read") \
    X(double, bearing_rad, DEG, "") \
    X(double, range_m, MM, "") \
    X(double, heading_rad, HEADING, "of the thing that bears it")

/* clang-format on */

#endif
