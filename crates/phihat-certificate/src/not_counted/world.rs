//! Of the world: what is in φ, in the loop model, or in nothing.

use phihat_study::{Drive, Loss, Network, Payload, World};

use super::list::{LeftOut, List};

impl List {
    pub(super) fn world(&mut self, world: &World, class: bool) {
        let World {
            // In φ along the reference; how they change with the error is in a tube.
            gravity: _,
            robot_friction: _,
            extra_coulomb: _,
            extra_viscous: _,
            pushes: _,
            // In the loop model.
            drive_bandwidth_hz: _,
            // Forbids the loop model.
            flexibility: _,
            // How finely the simulator integrates.
            substeps: _,
            substeps_stated: _,
            // Of the start; what was not counted of it dies out as all that is not there.
            held: _,
            warm_up,
            stiction,
            end_stops,
            walls,
            forces,
            drive,
            network,
            payload,
            start,
        } = world;
        self.values("world.friction_cold_factor", &[warm_up.0], 1.0);
        // A joint that sticks hangs on its bristles: another loop. To the bound for a class it is a force of any
        // course.
        let breakaway = stiction.as_ref().filter(|_| !class);
        let breakaway = breakaway.map(|stiction| &stiction.breakaway_ratio);
        self.acting("world.stiction.breakaway_ratio", breakaway);
        let stops = end_stops.as_ref().map(|stops| &stops.stiffness);
        self.acting("world.end_stops.stiffness_nm_rad", stops);
        for wall in walls {
            self.add("world.wall.stiffness_n_m", wall.stiffness, LeftOut::BoundsAndStability);
        }
        for force in forces {
            let text = format!("{:?} from {} s", force.force, force.start);
            self.add("world.push.force_n", text, LeftOut::Bounds);
        }
        if let Some(drive) = drive {
            self.drive(drive, class);
        }
        self.network(network, class);
        if let Some(payload) = payload {
            self.payload(payload);
        }
        if let Some(start) = start {
            // Bounds from φ are those of a loop at rest; a tube begins where the run does.
            self.add("start.q_rad", format!("{:?}", start.q), LeftOut::AllButTube);
        }
    }

    fn payload(&mut self, payload: &Payload) {
        let Payload {
            // In the range of inertia and in φ.
            frame: _,
            mass,
            com: _,
            inertia: _,
            start,
            end,
        } = payload;
        if *start > 0.0 || end.is_finite() {
            let text = format!("{mass} kg from {start} s to {end} s");
            self.add("world.payload", text, LeftOut::Bounds);
        }
    }

    fn drive(&mut self, drive: &Drive, class: bool) {
        let Drive {
            gain,
            gain_error,
            gain_drift,
            ripple,
            cogging,
            // How often ripple and cogging come round: nothing without them.
            ripple_per_turn: _,
            torque_max,
            torque_rate_max,
            no_load_speed,
        } = drive;
        // The window must hold for every gain; bounds are for a gain of 1.
        self.values("world.drive.gain", gain, 1.0);
        self.values("world.drive.gain_error", gain_error, 0.0);
        self.values("world.drive.gain_drift_per_s", gain_drift, 0.0);
        self.values("world.drive.ripple", ripple, 0.0);
        if !class {
            self.values("world.drive.cogging_nm", cogging, 0.0);
        }
        // The law does not see these limits: while one acts, nothing is claimed.
        self.acting("world.drive.torque_max_nm", torque_max.as_ref());
        self.acting("world.drive.torque_rate_max_nm_s", torque_rate_max.as_ref());
        self.acting("world.drive.no_load_speed_rad_s", no_load_speed.as_ref());
    }

    fn network(&mut self, network: &Network, class: bool) {
        let Network { command, sample, rows } = network;
        let losses =
            [("world.network.command_loss", command), ("world.network.sample_loss", sample)];
        for (key, loss) in losses {
            // How they come in a row is nothing without them.
            let Loss { share, burst: _ } = loss;
            if *share > 0.0 {
                self.add(key, share, LeftOut::BoundsAndStability);
            }
        }
        if let Some(rows) = rows.filter(|_| !class) {
            let text = format!("{} every {} s", rows.most, rows.apart);
            self.add("world.network.commands_lost_max", text, LeftOut::BoundsAndStability);
        }
    }
}
