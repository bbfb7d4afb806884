; SPDX-License-Identifier: Apache-2.0
; Scripts that CLIPS runs as a program and inside a robot: tests/rules/engine/run.

;;; sums
(defrule r
  =>
  (printout t (+ 1 2 3) crlf)
  (printout t (- 10 2.5) crlf)
  (printout t (* 3 4 0.5) crlf)
  (printout t (/ 7 2) crlf)
  (printout t (/ 8 2) crlf))

;;; whole division
(defrule r
  =>
  (printout t (div 17 5) crlf)
  (printout t (div -17 5) crlf)
  (printout t (div 17 -5) crlf)
  (printout t (div 100 3 4) crlf))

;;; remainders
(defrule r
  =>
  (printout t (mod 17 5) crlf)
  (printout t (mod -17 5) crlf)
  (printout t (mod 17 -5) crlf)
  (printout t (mod 7.5 2) crlf))

;;; extremes
(defrule r
  =>
  (printout t (max 3 9 2) crlf)
  (printout t (min 3 9 -2) crlf)
  (printout t (max 1 1.5) crlf)
  (printout t (abs -3) crlf)
  (printout t (abs -3.25) crlf))

;;; types
(defrule r
  =>
  (printout t (integer 3.9) crlf)
  (printout t (integer -3.9) crlf)
  (printout t (float 3) crlf)
  (printout t (round 2.5) crlf)
  (printout t (round 3.5) crlf)
  (printout t (round -2.5) crlf))

;;; powers
(defrule r
  =>
  (printout t (** 2 10) crlf)
  (printout t (** 2 0.5) crlf)
  (printout t (sqrt 16) crlf)
  (printout t (sqrt 2) crlf)
  (printout t (exp 1) crlf)
  (printout t (log 10) crlf)
  (printout t (log10 1000) crlf))

;;; angles
(defrule r
  =>
  (printout t (sin 0) crlf)
  (printout t (cos 0) crlf)
  (printout t (tan 0.5) crlf)
  (printout t (asin 1) crlf)
  (printout t (acos 0.25) crlf)
  (printout t (atan 1) crlf))

;;; hyperbolic
(defrule r
  =>
  (printout t (sinh 1) crlf)
  (printout t (cosh 1) crlf)
  (printout t (tanh 1) crlf)
  (printout t (asinh 1) crlf)
  (printout t (acosh 2) crlf)
  (printout t (atanh 0.5) crlf))

;;; rare angles
(defrule r
  =>
  (printout t (sec 1) crlf)
  (printout t (csc 1) crlf)
  (printout t (cot 1) crlf)
  (printout t (deg-rad 180) crlf)
  (printout t (rad-deg 1) crlf)
  (printout t (deg-grad 90) crlf)
  (printout t (pi) crlf))

;;; comparison
(defrule r
  =>
  (printout t (< 1 2 3) crlf)
  (printout t (< 1 3 2) crlf)
  (printout t (>= 3 3 1) crlf)
  (printout t (= 1 1.0) crlf)
  (printout t (<> 1 2) crlf)
  (printout t (eq 1 1.0) crlf)
  (printout t (neq 1 2 3) crlf))

;;; large
(defrule r
  =>
  (printout t 9223372036854775807 crlf)
  (printout t (- -9223372036854775807 1) crlf)
  (printout t (* 1000000 1000000) crlf)
  (printout t 1e300 crlf)
  (printout t 1.5e-7 crlf))

;;; printed floats
(defrule r
  =>
  (printout t (/ 1 3) crlf)
  (printout t 0.1 crlf)
  (printout t (+ 0.1 0.2) crlf)
  (printout t 1e20 crlf)
  (printout t 123456789.123456789 crlf)
  (printout t -0.0 crlf)
  (printout t 100.0 crlf))

;;; predicates
(defrule r
  =>
  (printout t (integerp 3) crlf)
  (printout t (floatp 3) crlf)
  (printout t (numberp 3.0) crlf)
  (printout t (evenp 4) crlf)
  (printout t (oddp 4) crlf)
  (printout t (numberp abc) crlf))

;;; mixed
(defrule r
  =>
  (printout t (+ 1 1.0) crlf)
  (printout t (* 2 2) crlf)
  (printout t (- 5 5) crlf)
  (printout t (/ 6 3 2) crlf)
  (printout t (+ -1 -1.5) crlf))
