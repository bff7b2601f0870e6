//! The peers of the sides: each is made when a side wants it first, for the host's scene and size.

use super::recipe::Recipe;
use crate::host::raster::node_camera;
use crate::host::{Host, HostError, Options, Shot};
use crate::measure::stats::Stats;
use crate::peers::msaa::{self, Msaa, Samples};
use crate::peers::taa::{self, Taa};
use crate::peers::{AnyPeer, Peer, Peers};
use crate::picture::Picture;
use crate::scene::Camera;
use deferred_aa::PassTime;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// The peers that were wanted so far.
#[derive(Default)]
pub struct SidePeers {
    images: Option<Peers>,
    histories: [Option<History>; 2],
    msaa: BTreeMap<Samples, Msaa>,
}

/// TAA over the frames of a side, and what these are frames of.
struct History {
    taa: Taa,
    recipe: Recipe,
    cuts: u64,
}

impl SidePeers {
    /// The pass of a peer on the host's picture.
    pub fn finish(&mut self, host: &Host, peer: Peer) -> Result<PassTime, HostError> {
        let peers = match &mut self.images {
            Some(peers) => peers,
            none => none.insert(Peers::new(&host.gpu, host.options.width, host.options.height)?),
        };
        Ok(peers.run(peer, host.target())?.pass(peer.name()))
    }

    /// A frame of a side with the history of those before it, unless there was a cut since: `cuts` counts them. The
    /// G-buffer is then that of a jittered camera.
    pub fn frame_in_history(
        &mut self,
        host: &mut Host,
        side: usize,
        camera: &Camera,
        recipe: Recipe,
        cuts: u64,
    ) -> Result<Shot, HostError> {
        let Options { width, height, m, .. } = host.options;
        let history = match &mut self.histories[side] {
            Some(history) => history,
            none => none.insert(History { taa: Taa::new(&host.gpu, width, height, m)?, recipe, cuts }),
        };
        if (history.recipe, history.cuts) != (recipe, cuts) {
            history.taa.cut();
            (history.recipe, history.cuts) = (recipe, cuts);
        }
        let camera = node_camera(camera, width, height);
        let mut shot = host.frame_with(history.taa.jittered(camera), recipe.recorded())?;
        if let Some(gbuffer) = host.aa.gbuffer() {
            let pass = history.taa.run(host.target(), &gbuffer.depth, camera)?.pass(taa::NAME);
            shot.statistics.passes.push(pass);
        }
        Ok(shot)
    }

    /// Forgets the frames of a side, which shows something else.
    pub fn end_history(&mut self, side: usize) {
        self.histories[side] = None;
    }

    /// The pass of a frame that is drawn forward, if that shows all that the frame is to show.
    pub fn forward(
        &mut self,
        host: &mut Host,
        samples: Samples,
        camera: &Camera,
        recipe: &Recipe,
    ) -> Result<PassTime, HostError> {
        if let Some(why) = msaa::refusal(samples, &host.gpu, &host.scene, &recipe.recorded()) {
            return Err(HostError::NoPeer(why.to_string()));
        }
        let camera = node_camera(camera, host.options.width, host.options.height);
        let msaa = match self.msaa.entry(samples) {
            Entry::Occupied(made) => made.into_mut(),
            Entry::Vacant(place) => place.insert(Msaa::new(host, samples)?),
        };
        Ok(msaa.run(host, camera)?.pass(samples.name()))
    }

    /// The picture of the last frame, which was of this side and recipe. Waits for the GPU.
    pub fn picture(&self, host: &Host, side: usize, recipe: &Recipe) -> Picture {
        let of_peer = recipe.peer().and_then(|peer| match peer {
            AnyPeer::Image(_) => Some(self.images.as_ref()?.picture()),
            AnyPeer::Taa => Some(self.histories[side].as_ref()?.taa.picture()),
            AnyPeer::Msaa(samples) => Some(self.msaa.get(&samples)?.picture(host)),
        });
        of_peer.unwrap_or_else(|| host.picture())
    }

    /// A recipe's statistics with what the node does not know of.
    pub fn complete(&self, recipe: &Recipe, stats: Stats) -> Stats {
        match recipe.peer() {
            Some(AnyPeer::Msaa(samples)) => stats.holding(self.msaa.get(&samples).map_or(0, Msaa::bytes)),
            _ => stats,
        }
    }
}

#[cfg(test)]
mod tests;
