; SPDX-License-Identifier: Apache-2.0
;
; A monitor that says when a robot is stalled and when it is free again, and who was stalled
; longest: muster monitor --rules rules/monitor_stalls.clp

(defrule stall-begins
  (robot (name ?name) (stalled TRUE) (x ?x) (y ?y))
  (step (time ?time))
  (not (stalled ?name))
  =>
  (assert (stalled ?name))
  (format t "%.1f s: %s is stalled at %.0f %.0f%n" ?time ?name ?x ?y))

(defrule stall-ends
  ?known <- (stalled ?name)
  (robot (name ?name) (stalled FALSE))
  (step (time ?time))
  =>
  (retract ?known)
  (format t "%.1f s: %s is free%n" ?time ?name))

(defrule summary
  (run-ended (how ?how) (time ?time))
  (team (distance ?distance) (most-efficient ?best))
  (robot (name ?worst) (stalled-time ?longest))
  (not (robot (stalled-time ?more&:(> ?more ?longest))))
  (not (summed-up))
  =>
  (assert (summed-up))
  (format t "%s after %.1f s: %.1f m, most efficient %s" ?how ?time (/ ?distance 1000.0) ?best)
  (if (> ?longest 0.0) then
    (format t ", longest stalled %s, %.1f s" ?worst ?longest))
  (printout t crlf))
