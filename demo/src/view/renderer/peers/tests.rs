use super::super::event::Event;
use super::super::recipe::Maker;
use super::super::shared::Shared;
use super::super::thread::Renderer;
use super::super::{Lights, Rendered, Source, View, Wanted};
use super::*;
use crate::measure::quality;
use crate::peers::msaa::Refusal;
use crate::peers::taa::STILL_FRAMES;
use deferred_aa::{Settings, Technique};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Condvar, Mutex};

/// The renderer without its thread.
struct Rig {
    renderer: Renderer,
    events: Receiver<Event>,
    wanted: Wanted,
}

impl Rig {
    /// With this maker on the right side, and full supersampling on the left one.
    fn new(scene: &str, maker: Maker) -> Self {
        let wanted = Wanted {
            scene: (Source::default(), 0),
            view: None,
            cuts: 0,
            sides: [of(Maker::Node), of(maker)].map(Some),
            frames: 2,
            reference: super::super::Reference::Off,
            paused: false,
            quit: false,
        };
        let shared = Arc::new(Shared { wanted: Mutex::new(wanted.clone()), changed: Condvar::new() });
        let (say, events) = channel();
        let options = Options::new(96, 54, 4);
        let renderer = Renderer::new(shared, options, None, Box::new(move |event| drop(say.send(event))));
        let mut rig = Self { renderer, events, wanted };
        rig.open(scene);
        rig
    }

    /// Opens a scene, and wants its first view.
    fn open(&mut self, scene: &str) {
        self.wanted.scene = (Source { name: scene.to_owned(), index: None }, self.wanted.scene.1 + 1);
        self.wanted.view = None;
        let opened = self.rest().into_iter().find_map(|event| match event {
            Event::Opened(opened) => Some(opened),
            _ => None,
        });
        let opened = opened.unwrap();
        let (options, lights) = (Options::new(96, 54, 4), Lights { stall: 1, count: u32::MAX, sun: None });
        self.wanted.view = Some(View { opening: opened.opening, options, lights, camera: opened.cameras[0] });
    }

    /// All that is said until there is nothing to do.
    fn rest(&mut self) -> Vec<Event> {
        while self.renderer.step(&self.wanted).unwrap() {}
        self.events.try_iter().collect()
    }

    /// The pictures of the right side until there is nothing to do.
    fn pictures(&mut self) -> Vec<Rendered> {
        let pictures = self.rest().into_iter().filter_map(|event| match event {
            Event::Picture(1, rendered) => Some(*rendered),
            _ => None,
        });
        pictures.collect()
    }

    /// The first picture of the right side, of what is wanted now.
    fn first(&mut self) -> Picture {
        let pictures = self.pictures();
        assert_eq!(pictures.len(), STILL_FRAMES as usize);
        Picture::clone(&pictures[0].picture)
    }

    fn view(&mut self) -> &mut View {
        self.wanted.view.as_mut().unwrap()
    }
}

/// A peer, or full supersampling.
fn of(maker: Maker) -> Recipe {
    Recipe { maker, settings: Settings { technique: Technique::Full, ..Settings::default() } }
}

#[test]
fn a_history_settles_on_a_still_camera_and_rests() {
    let mut rig = Rig::new("fence", Maker::Taa);
    let events = rig.rest();
    let mut full = None;
    let mut pictures = Vec::new();
    let mut measured = [0, 0];
    for event in events {
        match event {
            Event::Picture(0, rendered) => full = Some(rendered.picture),
            Event::Picture(_, rendered) => {
                assert_eq!(measured, [0, 0], "measured before it is settled");
                pictures.push(rendered);
            }
            Event::Measured(side, ..) => measured[side] += 1,
            _ => {}
        }
    }
    assert_eq!(measured, [2, 2]);
    let left: Vec<_> = pictures.iter().map(|rendered| rendered.unsettled).collect();
    assert_eq!(left, (0..STILL_FRAMES).rev().collect::<Vec<_>>());
    let names = |rendered: &Rendered| rendered.shot.statistics.passes.iter().any(|pass| pass.name == taa::NAME);
    assert!(pictures.iter().all(|rendered| names(rendered)));
    let full = full.unwrap();
    let db = |rendered: &Rendered| quality::psnr(&rendered.picture, &full).unwrap();
    let (first, last) = (db(&pictures[0]), db(pictures.last().unwrap()));
    println!("{first:.2} dB after one frame, {last:.2} dB at rest");
    assert!(last > first + 3.0, "{first} dB, then {last} dB");
    assert!(rig.rest().is_empty());
}

/// Frames go on from those before them until a cut, after which they are those of the beginning.
#[test]
fn a_history_ends_where_the_view_is_another() {
    let mut rig = Rig::new("fence", Maker::Taa);
    let fresh = rig.first();
    let home = rig.view().camera;
    let moved = Camera { eye: home.eye + (home.target - home.eye) * 1e-3, ..home };
    rig.view().camera = moved;
    rig.first();
    rig.view().camera = home;
    assert!(rig.first() != fresh, "what moves keeps its history");
    rig.view().camera = moved;
    rig.first();
    rig.view().camera = home;
    rig.wanted.cuts += 1;
    assert!(rig.first() == fresh, "a cut");
    rig.view().options.width = 80;
    rig.first();
    rig.view().options.width = 96;
    assert!(rig.first() == fresh, "another size");
    rig.view().options.m = 2;
    rig.first();
    rig.view().options.m = 4;
    assert!(rig.first() == fresh, "another m");
    let recipe = rig.wanted.sides[1];
    rig.wanted.sides[1] = Some(of(Maker::Fxaa));
    assert_eq!(rig.pictures().len(), 1);
    rig.wanted.sides[1] = recipe;
    assert!(rig.first() == fresh, "another maker between");
    rig.open("fence");
    assert!(rig.first() == fresh, "another scene");
}

/// The node's pictures are those of its own camera, whatever the other side's jitter was.
#[test]
fn a_jittered_frame_is_no_gbuffer_of_the_other_side() {
    let single = Recipe::node(Settings { technique: Technique::Single, ..Settings::default() });
    let pictures = [Maker::Taa, Maker::Fxaa].map(|maker| {
        let mut rig = Rig::new("fence", maker);
        rig.rest();
        rig.wanted.sides[0] = Some(single);
        let picture = rig.rest().into_iter().find_map(|event| match event {
            Event::Picture(0, rendered) => Some(rendered.picture),
            _ => None,
        });
        picture.unwrap()
    });
    assert!(pictures[0] == pictures[1]);
}

#[test]
fn forward_shading_is_drawn_or_refused_in_words() {
    let settings = of(Maker::Node).recorded();
    for samples in Samples::ALL {
        let mut rig = Rig::new("fence", Maker::Msaa(samples));
        let events = rig.rest();
        let host = rig.renderer.stage.host.as_ref().unwrap();
        let refusal = msaa::refusal(samples, &host.gpu, &host.scene, &settings);
        assert!(samples != Samples::Four || refusal.is_none());
        if let Some(why) = refusal {
            let said = |event: &Event| matches!(event, Event::Refused(1, _, text) if *text == why.to_string());
            assert!(events.iter().any(said), "{events:?}");
            assert!(!events.iter().any(|event| matches!(event, Event::Picture(1, _))));
            continue;
        }
        let picture = |side: usize| {
            let mut all = events.iter();
            all.find_map(|event| match event {
                Event::Picture(of, rendered) if *of == side => Some(rendered.clone()),
                _ => None,
            })
        };
        let (full, own) = (picture(0).unwrap(), picture(1).unwrap());
        let names: Vec<_> = own.shot.statistics.passes.iter().map(|pass| pass.name).collect();
        assert_eq!((names, own.shot.gbuffer_ms, own.unsettled), (vec![samples.name()], Some(0.0), 0));
        let bytes = 96 * 54 * (u64::from(samples.count()) * 12 + 8);
        assert_eq!(own.stats.as_ref().unwrap().memory_bytes.gbuffer(), bytes);
        let db = quality::psnr(&own.picture, &full.picture).unwrap();
        println!("{samples:?}: {db:.2} dB");
        assert!(db > 26.0, "{samples:?}: {db} dB");
        // Where rays are wanted of it, it is refused, and the other side goes on.
        rig.open("mirrors");
        let events = rig.rest();
        let refused =
            |event: &Event| matches!(event, Event::Refused(1, _, text) if *text == Refusal::Scene.to_string());
        assert!(events.iter().any(refused), "{events:?}");
        assert!(events.iter().any(|event| matches!(event, Event::Picture(0, _))));
    }
}
