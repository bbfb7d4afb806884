; SPDX-License-Identifier: Apache-2.0
; Seats guests round a table so that neighbours differ in sex and share a hobby: the problem of Miss
; Manners, which makes an engine join large memories.  Data: bench/minds/run.
(deftemplate guest (slot name) (slot sex) (slot hobby))
(deftemplate seating (slot id) (slot before) (slot right) (slot seat) (slot whole))

(defrule first
  ?phase <- (phase begin)
  (guest (name ?name))
  =>
  (retract ?phase)
  (assert (seating (id 1) (before 0) (right ?name) (seat 1) (whole yes)) (path 1 ?name 1) (next 2)
          (phase seat)))

(defrule seat
  ?phase <- (phase seat)
  (seating (id ?id) (right ?left) (seat ?seat) (whole yes))
  (guest (name ?left) (sex ?sex) (hobby ?hobby))
  (guest (name ?right) (sex ~?sex) (hobby ?hobby))
  ?next <- (next ?n)
  (not (path ?id ?right ?))
  (not (chosen ?id ?right ?hobby))
  =>
  (retract ?phase ?next)
  (assert (seating (id ?n) (before ?id) (right ?right) (seat (+ ?seat 1)) (whole no))
          (path ?n ?right (+ ?seat 1)) (chosen ?id ?right ?hobby) (next (+ ?n 1)) (phase copy)))

(defrule copy
  (phase copy)
  (seating (id ?id) (before ?before) (whole no))
  (path ?before ?name ?seat)
  (not (path ?id ?name ?))
  =>
  (assert (path ?id ?name ?seat)))

(defrule copied
  (declare (salience -1))
  ?phase <- (phase copy)
  ?seating <- (seating (whole no))
  =>
  (modify ?seating (whole yes))
  (retract ?phase)
  (assert (phase look)))

(defrule all-sit
  (declare (salience 1))
  (phase look)
  (seats ?seats)
  (seating (id ?id) (seat ?seats) (whole yes))
  =>
  (printout t "seated " ?seats " in " ?id " tries" crlf)
  (halt))

(defrule go-on
  ?phase <- (phase look)
  =>
  (retract ?phase)
  (assert (phase seat)))
