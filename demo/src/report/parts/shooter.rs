//! Frames of entries: of a technique, or of a peer.

use crate::host::{Host, Shot};
use crate::measure::stats::Stats;
use crate::peers::msaa::{Msaa, Samples};
use crate::peers::taa::{self, STILL_FRAMES, Taa};
use crate::peers::{AnyPeer, Peers};
use crate::picture::Picture;
use crate::report::ReportError;
use crate::report::plan::Planned;
use deferred_aa::Camera;
use std::collections::BTreeMap;

/// A host, and the peers if entries have them.
#[derive(Debug)]
pub struct Shooter {
    /// The host.
    pub host: Host,
    peers: Option<Peers>,
    taa: Option<Taa>,
    msaa: BTreeMap<Samples, Msaa>,
}

impl Shooter {
    /// A shooter for these entries, all of the host's m.
    pub fn new(host: Host, entries: &[Planned]) -> Result<Self, ReportError> {
        let (width, height) = (host.options.width, host.options.height);
        let images = entries.iter().any(|e| matches!(e.peer, Some(AnyPeer::Image(_))));
        let peers = images.then(|| Peers::new(&host.gpu, width, height)).transpose()?;
        let taa =
            entries.iter().any(has_history).then(|| Taa::new(&host.gpu, width, height, host.options.m)).transpose()?;
        let mut msaa = BTreeMap::new();
        for entry in entries {
            if let Some(AnyPeer::Msaa(samples)) = entry.peer {
                msaa.insert(samples, Msaa::new(&host, samples)?);
            }
        }
        Ok(Self { host, peers, taa, msaa })
    }

    /// One frame of an entry; a peer's pass comes last. What renders frames of its own has the statistics of its settings
    /// and no times but its own.
    pub fn shoot(&mut self, planned: &Planned, camera: Camera) -> Result<Shot, ReportError> {
        let rendered = match &self.taa {
            Some(taa) if has_history(planned) => taa.jittered(camera),
            _ => camera,
        };
        let mut shot = self.host.frame_with(rendered, planned.settings)?;
        if let Some(AnyPeer::Msaa(samples)) = planned.peer
            && let Some(msaa) = self.msaa.get_mut(&samples)
        {
            shot.statistics.passes = vec![msaa.run(&mut self.host, camera)?.pass(samples.name())];
            return Ok(Shot { gbuffer_ms: Some(0.0), ..shot });
        }
        let peer = match (planned.peer, &mut self.peers, &mut self.taa, self.host.aa.gbuffer()) {
            (Some(AnyPeer::Image(peer)), Some(peers), ..) => peers.run(peer, self.host.target())?.pass(peer.name()),
            (Some(AnyPeer::Taa), _, Some(taa), Some(gbuffer)) => {
                taa.run(self.host.target(), &gbuffer.depth, camera)?.pass(taa::NAME)
            }
            _ => return Ok(shot),
        };
        shot.statistics.passes.push(peer);
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

    /// An entry's statistics with what the node does not know of.
    pub fn complete(&self, planned: &Planned, stats: Stats) -> Stats {
        let Some(peer) = planned.peer else { return stats };
        let stats = stats.of_peer(peer.name());
        match self.msaa_of(planned) {
            Some(msaa) => stats.holding(msaa.bytes()),
            None => stats,
        }
    }

    fn msaa_of(&self, planned: &Planned) -> Option<&Msaa> {
        let Some(AnyPeer::Msaa(samples)) = planned.peer else { return None };
        self.msaa.get(&samples)
    }

    /// The picture of the last frame, which was of this entry. Waits for the GPU.
    pub fn picture(&self, planned: &Planned) -> Picture {
        if let Some(msaa) = self.msaa_of(planned) {
            return msaa.picture(&self.host);
        }
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
