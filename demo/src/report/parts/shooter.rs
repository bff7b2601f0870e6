//! Frames of entries: of a technique, or of a peer.

use crate::host::{Host, Shot};
use crate::peers::taa::{PHASES, Taa};
use crate::peers::{AnyPeer, Peers};
use crate::picture::Picture;
use crate::report::ReportError;
use crate::report::plan::Planned;
use deferred_aa::{Camera, PassKind, PassTime};

/// Frames of a still camera until a history has settled: what is left of the first then is 3 %.
const STILL_FRAMES: u32 = 2 * PHASES;

/// A host, and the peers if entries have them.
#[derive(Debug)]
pub struct Shooter {
    /// The host.
    pub host: Host,
    peers: Option<Peers>,
    taa: Option<Taa>,
}

impl Shooter {
    /// A shooter for these entries, all of the host's m.
    pub fn new(host: Host, entries: &[Planned]) -> Result<Self, ReportError> {
        let (width, height) = (host.options.width, host.options.height);
        let images = entries.iter().any(|e| matches!(e.peer, Some(AnyPeer::Image(_))));
        let peers = images.then(|| Peers::new(&host.gpu, width, height)).transpose()?;
        let taa = entries.iter().any(has_history).then(|| Taa::new(&host.gpu, width, height)).transpose()?;
        Ok(Self { host, peers, taa })
    }

    /// One frame of an entry; a peer's pass comes last.
    pub fn shoot(&mut self, planned: &Planned, camera: Camera) -> Result<Shot, ReportError> {
        let rendered = match &self.taa {
            Some(taa) if has_history(planned) => taa.jittered(camera),
            _ => camera,
        };
        let mut shot = self.host.frame_with(rendered, planned.settings)?;
        let milliseconds = match (planned.peer, &mut self.peers, &mut self.taa, self.host.aa.gbuffer()) {
            (Some(AnyPeer::Image(peer)), Some(peers), ..) => peers.run(peer, self.host.target())?.milliseconds,
            (Some(AnyPeer::Taa), _, Some(taa), Some(gbuffer)) => {
                taa.run(self.host.target(), &gbuffer.depth, camera)?.milliseconds
            }
            _ => return Ok(shot),
        };
        let name = planned.peer.map_or("", AnyPeer::name);
        shot.statistics.passes.push(PassTime { name, kind: PassKind::Host, milliseconds });
        Ok(shot)
    }

    /// Frames of a still camera after a cut, until the picture is what it stays. `tick` is called before each.
    pub fn settle(
        &mut self,
        planned: &Planned,
        camera: Camera,
        mut tick: impl FnMut() -> Result<(), ReportError>,
    ) -> Result<(), ReportError> {
        self.cut(planned);
        for _ in 0..if has_history(planned) { STILL_FRAMES } else { 1 } {
            tick()?;
            self.shoot(planned, camera)?;
        }
        Ok(())
    }

    /// The camera cuts: an entry with a history starts anew, as engines have it.
    pub fn cut(&mut self, planned: &Planned) {
        if let Some(taa) = self.taa.as_mut().filter(|_| has_history(planned)) {
            taa.cut();
        }
    }

    /// The picture of the last frame, which was of this entry. Waits for the GPU.
    pub fn picture(&self, planned: &Planned) -> Picture {
        match (planned.peer, &self.peers, &self.taa) {
            (Some(AnyPeer::Image(_)), Some(peers), _) => peers.picture(),
            (Some(AnyPeer::Taa), _, Some(taa)) => taa.picture(),
            _ => self.host.picture(),
        }
    }
}

/// Whether an entry's frames depend on those before them.
pub fn has_history(planned: &Planned) -> bool {
    planned.peer == Some(AnyPeer::Taa)
}
