//! The calls of a stroke: begin, move, end, cancel.

use std::sync::Arc;

use isochore_field as field;

use super::{
    InteractiveRefinement, LockSkipped, MoveReceipt, Session, SessionError, SessionTool, StrokeOptions, StrokeReceipt,
    history::Step,
    locking::Locked,
    log::{self, LoggedStroke},
    path::Segment,
    stroke::ActiveStroke,
    surface::Surface,
};
use crate::recipe::Key;

impl Session {
    /// Begins a stroke. Nothing moves before the second pose.
    ///
    /// # Errors
    /// [`SessionError::StrokeUnderWay`], [`SessionError::Refinement`].
    pub fn begin_stroke(&mut self, tool: &Arc<SessionTool>, options: StrokeOptions) -> Result<(), SessionError> {
        if self.stroke.is_some() {
            return Err(SessionError::StrokeUnderWay);
        }
        options.refine.as_ref().map_or(Ok(()), InteractiveRefinement::check)?;
        let alive = self.surface.begin();
        self.stroke = Some(ActiveStroke::new(Arc::clone(tool), options.refine, alive));
        Ok(())
    }

    /// Moves the tool to `pose` (world from tool) and deforms the surface on its path. The first
    /// pose of a stroke only places the tool.
    ///
    /// Consecutive poses are joined by a constant body twist, which is a screw motion of less than
    /// half a turn. `time` is the host's clock in seconds. It must not decrease; it is reported in
    /// the receipt and does not influence the deformation.
    ///
    /// The log records axis and angle of the rotation in degrees, and the tool moves to the pose
    /// that this record stands for, so that a replay gives the same bits. It differs from `pose` by
    /// rounding. To choose the recorded numbers, use [`move_to_key`](Self::move_to_key).
    ///
    /// # Errors
    /// [`SessionError`]. The tool is then still at the last pose, and the stroke can continue from
    /// there.
    pub fn move_to(&mut self, pose: &field::Pose, time: f64) -> Result<MoveReceipt, SessionError> {
        if !(pose.translation.is_finite() && pose.rotation.is_finite()) {
            return Err(field::StrokeError::Move(field::MoveError::NotFinite).into());
        }
        self.move_to_key(&log::key(pose), time)
    }

    /// [`move_to`](Self::move_to) for a pose given as position, axis and angle in degrees. The log
    /// records `key` exactly as given.
    ///
    /// # Errors
    /// [`SessionError`]. The tool is then still at the last pose, and the stroke can continue from
    /// there.
    pub fn move_to_key(&mut self, key: &Key, time: f64) -> Result<MoveReceipt, SessionError> {
        let pose = key.pose()?;
        let stroke = self.stroke.as_mut().ok_or(SessionError::NoStroke)?;
        let last = stroke.times.last().copied().unwrap_or(f64::NEG_INFINITY);
        if !(time.is_finite() && time >= last) {
            return Err(SessionError::Time { time, last });
        }
        if let Some(stopped) = &mut stroke.stopped {
            stopped.asked += 1;
            return Ok(MoveReceipt { is_stopped: true, ..MoveReceipt::default() });
        }
        let mut receipt = MoveReceipt::default();
        if let Some(last) = stroke.pose {
            let tool = Arc::clone(&stroke.tool);
            let segment = self.segment(&tool, [last, pose])?;
            receipt = self.advect(segment)?;
        }
        if let Some(stroke) = &mut self.stroke {
            stroke.receipt.moves += usize::from(stroke.pose.is_some());
            stroke.keys.push(key.clone());
            stroke.times.push(time);
            stroke.pose = Some(pose);
        }
        self.rebase_if_due(&mut receipt);
        Ok(receipt)
    }

    /// The move of a tool between two poses.
    pub(super) fn segment(&self, tool: &SessionTool, poses: [field::Pose; 2]) -> Result<Segment, field::StrokeError> {
        let motion = field::Move::new(Arc::clone(tool.tool()), poses.to_vec(), self.options.step)?;
        let mut stroke = field::Stroke::Move(motion);
        if let Some(mask) = &self.mask {
            stroke = stroke.masked(mask, self.opened_bounds, self.options.step)?;
        }
        Ok(Segment::new(stroke))
    }

    /// Ends the stroke, adds it to the log and makes it undoable. A stroke of fewer than two poses
    /// leaves no trace.
    ///
    /// If the session has a volume lock, the lock acts now. It displaces what the host sees, but
    /// the next stroke starts from the surface without the lock. The volume in the receipt is the
    /// change before the lock.
    ///
    /// # Errors
    /// [`SessionError::NoStroke`].
    pub fn end_stroke(&mut self) -> Result<StrokeReceipt, SessionError> {
        let mut stroke = self.stroke.take().ok_or(SessionError::NoStroke)?;
        self.certify(&mut stroke);
        if stroke.keys.len() > 1 {
            let touched = stroke.touched.items().to_vec();
            self.tidy(&mut stroke, &touched);
        }
        if stroke.has_crossings {
            let crossing = self.surface.new_crossings(stroke.touched.items(), Surface::position);
            stroke.receipt.crossings = crossing.len();
        }
        let mut receipt = stroke.receipt;
        receipt.stopped_at = stroke.stopped_at();
        receipt.sheets = stroke.stopped.and_then(|stopped| stopped.sheets);
        if let [first, .., last] = stroke.times[..] {
            receipt.duration = last - first;
        }
        let bases = &self.surface.bases;
        receipt.touched_vertices =
            self.surface.positions.edited().filter(|&vertex| bases.inserted_at(vertex).is_none()).count();
        receipt.volume = self.opened_volume.map(|_| stroke.volume(&self.surface));
        let locked = self.lock(&stroke);
        (receipt.lock_max_shift, receipt.lock_skipped) = (locked.max_shift.ok(), locked.max_shift.err());
        let mut delta = self.surface.finish(stroke.alive);
        if stroke.keys.len() < 2 {
            self.surface.swap(&mut delta);
            return Ok(receipt);
        }
        let volume_change = receipt.volume.map(|volume| volume.total());
        let stroke = LoggedStroke {
            tool: stroke.tool,
            keys: stroke.keys,
            volume_change,
            shown_change: locked.shown_change,
            crossings: receipt.crossings,
        };
        let step = Step { stroke, delta };
        receipt.undo_bytes = step.bytes();
        receipt.forgotten_strokes = self.steps.push(step, self.options.undo_bytes);
        Ok(receipt)
    }

    /// Locks the volume that the host sees, if the session has a lock and the surface has a volume.
    fn lock(&mut self, stroke: &ActiveStroke) -> Locked {
        let unlocked = |skipped| Locked { max_shift: Err(skipped), shown_change: 0.0 };
        let Some(volume) = self.opened_volume else { return unlocked(LockSkipped::NeedsClosed) };
        if !self.options.lock {
            return unlocked(LockSkipped::Off);
        }
        let excess = self.shown_volume_change();
        stroke.lock(&mut self.surface, excess, volume.abs())
    }

    /// Cancels the stroke under way and restores all bits.
    ///
    /// # Errors
    /// [`SessionError::NoStroke`].
    pub fn cancel_stroke(&mut self) -> Result<(), SessionError> {
        let stroke = self.stroke.take().ok_or(SessionError::NoStroke)?;
        let mut delta = self.surface.finish(stroke.alive);
        self.surface.swap(&mut delta);
        Ok(())
    }
}
