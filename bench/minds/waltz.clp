; SPDX-License-Identifier: Apache-2.0
; Labels the lines of a drawing of blocks as convex, concave or border, after Waltz: each junction
; has readings, and one that no reading of a neighbour agrees with goes.  Data: bench/minds/run.
(deftemplate junction (slot id) (slot kind) (multislot lines))
(deftemplate reading (slot junction) (slot line) (slot label) (slot number))

; A border is `in` or `out` as seen from the junction: what leaves one comes into the other.
(deffacts agreement
  (agree + +) (agree - -) (agree in out) (agree out in))

(deffacts dictionary
  (may ell in out) (may ell out in) (may ell + out) (may ell in +) (may ell - in) (may ell out -)
  (may fork + + +) (may fork - - -) (may fork in - out) (may fork - out in) (may fork out in -)
  (may arrow in + out) (may arrow - + -) (may arrow + - +)
  (may tee out + in) (may tee out - in) (may tee out in in) (may tee out out in))

(defrule read
  (declare (salience 10))
  (junction (id ?j) (kind ?kind) (lines $?lines))
  ?entry <- (may ?kind $?labels)
  =>
  (progn$ (?line ?lines)
    (assert (reading (junction ?j) (line ?line) (label (nth$ ?line-index ?labels))
                     (number (fact-index ?entry))))))

(defrule disagree
  (reading (junction ?j) (line ?line) (label ?label) (number ?n))
  (reading (junction ?k&~?j) (line ?line))
  (agree ?label ?other)
  (not (reading (junction ?k) (line ?line) (label ?other)))
  =>
  (assert (wrong ?j ?n)))

(defrule remove
  (declare (salience 5))
  (wrong ?j ?n)
  ?reading <- (reading (junction ?j) (number ?n))
  =>
  (retract ?reading))

(defrule count
  (declare (salience -10))
  =>
  (bind ?left 0)
  (do-for-all-facts ((?r reading)) TRUE (bind ?left (+ ?left 1)))
  (printout t "readings left " ?left crlf))
