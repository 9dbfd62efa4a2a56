//! Forward dynamics of a planar arm of three joints: what `lockstep::sweep::placed` does with it, 135 operations.
//!
//! Written by a test (`written::kernels`): not to be edited.

use super::{Code, ArmNumbers};
use crate::Scalar;
use crate::shape::{SegmentShape, Tilt};

pub(super) struct Chain;

impl Code<3> for Chain {
    const SHAPES: [SegmentShape; 3] = [
        SegmentShape { tilt: Tilt::Level, reaches: false, slides: false },
        SegmentShape { tilt: Tilt::Level, reaches: true, slides: false },
        SegmentShape { tilt: Tilt::Level, reaches: true, slides: false },
    ];

    #[inline(always)]
    fn forward<S: Scalar>(arm: &impl ArmNumbers<S>) -> [S; 3] {
        let v60 = arm.lift(0); let v66 = arm.cosine(0); let v75 = v60 * v66; let v61 = arm.lift(1);
        let v63 = arm.sine(0); let v76 = v61 * v63; let v77 = v75 + v76; let v78 = v61 * v66; let v79 = v60 * v63;
        let v80 = v78 - v79; let v69 = arm.dq(0); let v81 = v69 * v69; let v5 = arm.h(0, 0); let v104 = v5 * v80;
        let v6 = arm.h(0, 1); let v105 = v6 * v77; let v106 = v104 - v105; let v20 = arm.a(1); let v109 = v20 * v81;
        let v111 = v77 - v109; let v67 = arm.cosine(1); let v112 = v67 * v111; let v64 = arm.sine(1);
        let v113 = v64 * v80; let v114 = v112 + v113; let v115 = v67 * v80; let v116 = v64 * v111;
        let v117 = v115 - v116; let v70 = arm.dq(1); let v118 = v69 + v70; let v119 = v118 * v118; let v24 = arm.m(1);
        let v127 = v24 * v114; let v128 = v24 * v117; let v25 = arm.h(1, 0); let v130 = v25 * v119;
        let v26 = arm.h(1, 1); let v132 = v26 * v119; let v134 = v127 - v130; let v135 = v128 - v132;
        let v142 = v25 * v117; let v143 = v26 * v114; let v144 = v142 - v143; let v40 = arm.a(2); let v147 = v40 * v119;
        let v149 = v114 - v147; let v68 = arm.cosine(2); let v150 = v68 * v149; let v65 = arm.sine(2);
        let v151 = v65 * v117; let v152 = v150 + v151; let v153 = v68 * v117; let v154 = v65 * v149;
        let v155 = v153 - v154; let v71 = arm.dq(2); let v156 = v71 + v118; let v157 = v156 * v156; let v44 = arm.m(2);
        let v165 = v44 * v152; let v166 = v44 * v155; let v45 = arm.h(2, 0); let v168 = v45 * v157;
        let v46 = arm.h(2, 1); let v170 = v46 * v157; let v172 = v165 - v168; let v173 = v166 - v170;
        let v180 = v45 * v155; let v181 = v46 * v152; let v182 = v180 - v181; let v43 = arm.armature(2);
        let v50 = arm.inertia(2, 2); let v186 = v43 + v50; let v74 = arm.tau(2); let v187 = v182 - v74;
        let v188 = v45 * v68; let v189 = v46 * v65; let v190 = v188 - v189; let v191 = v45 * v65; let v192 = v46 * v68;
        let v193 = v191 + v192; let v220 = v40 * v44; let v221 = v190 + v190; let v222 = v220 + v221;
        let v223 = v40 * v222; let v224 = v190 + v220; let v226 = v50 + v223; let v231 = -v192; let v232 = v231 - v191;
        let v234 = v40 * v190; let v235 = v50 + v234; let v236 = v68 * v172; let v237 = v65 * v173;
        let v238 = v236 - v237; let v239 = v65 * v172; let v240 = v68 * v173; let v241 = v239 + v240;
        let v250 = v40 * v241; let v251 = v182 + v250; let v252 = v24 + v44; let v253 = v25 + v224;
        let v254 = v26 + v193; let v30 = arm.inertia(1, 2); let v258 = v30 + v226; let v262 = v134 + v238;
        let v263 = v135 + v241; let v267 = v144 + v251; let v23 = arm.armature(1); let v269 = v23 + v258;
        let v73 = arm.tau(1); let v270 = v267 - v73; let v271 = v67 * v253; let v272 = v64 * v254;
        let v273 = v271 - v272; let v303 = v20 * v252; let v304 = v273 + v273; let v305 = v303 + v304;
        let v306 = v20 * v305; let v309 = v258 + v306; let v317 = v20 * v273; let v318 = v258 + v317;
        let v322 = v64 * v232; let v323 = v67 * v190; let v324 = v322 + v323; let v331 = v20 * v324;
        let v332 = v235 + v331; let v336 = v64 * v262; let v337 = v67 * v263; let v338 = v336 + v337;
        let v347 = v20 * v338; let v348 = v267 + v347; let v10 = arm.inertia(0, 2); let v355 = v10 + v309;
        let v364 = v106 + v348; let v3 = arm.armature(0); let v366 = v3 + v355; let v72 = arm.tau(0);
        let v367 = v364 - v72; let v368 = S::splat(1.0); let v369 = v368 / v366; let v370 = v318 * v369;
        let v371 = v318 * v370; let v372 = v269 - v371; let v373 = v332 * v370; let v374 = v235 - v373;
        let v375 = v367 * v370; let v376 = v270 - v375; let v377 = v332 * v369; let v378 = v332 * v377;
        let v379 = v186 - v378; let v380 = v367 * v377; let v381 = v187 - v380; let v382 = v368 / v372;
        let v383 = v374 * v382; let v384 = v374 * v383; let v385 = v379 - v384; let v386 = v376 * v383;
        let v387 = v381 - v386; let v388 = v368 / v385; let v389 = v387 * v388; let v390 = -v389;
        let v391 = v374 * v389; let v393 = v376 - v391; let v394 = v382 * v393; let v395 = -v394;
        let v396 = v318 * v394; let v398 = v367 - v396; let v399 = v332 * v389; let v401 = v398 - v399;
        let v402 = v369 * v401; let v403 = -v402;
        [v403, v395, v390]
    }
}
